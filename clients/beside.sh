# beside.sh: for scripts that run programs beside them until they end: `. clients/beside.sh` after setting `state` (a folder of
# theirs). Whatever ends the script, on Ctrl-C too, ends the processes in `processes`, first to last, and takes the folder away.
processes=

stop_beside() {
    status=$?
    trap - EXIT INT TERM HUP
    for process in $processes; do
        kill -TERM "$process" 2>/dev/null || true
        wait "$process" 2>/dev/null || true
    done
    rm -rf "$state"
    exit "$status"
}
trap stop_beside EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

# said FILE PATTERN PROCESS: the word that the program wrote behind the pattern, once it has; 10 s are plenty. Fails where it
# ends or says nothing.
said() {
    tries=0
    until text=$(sed -n "s/.*$2\([^ ]*\).*/\1/p" "$1" | head -n 1) && [ -n "$text" ]; do
        tries=$((tries + 1))
        if ! kill -0 "$3" 2>/dev/null || [ "$tries" -gt 100 ]; then
            return 1
        fi
        sleep 0.1
    done
    echo "$text"
}
