# start_awtd.sh: for scripts that play through a daemon of their own: `. tests/start_awtd.sh` after setting `build` (where
# awtd is) and `work` (a folder of theirs), and `awtd_options` where it is to have more. Sets `daemon`, which they must
# end, and `address`, empty if it does not listen; its token is $work/state/token.
"$build/awtd" --listen 127.0.0.1:0 --state-dir "$work/state" ${awtd_options:-} >"$work/out" 2>"$work/log" &
daemon=$!
address=
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    address=$(sed -n 's/^listening on //p' "$work/out")
    [ -n "$address" ] && break
    sleep 0.5
done
