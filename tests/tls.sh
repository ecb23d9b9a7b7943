#!/bin/sh
# tls.sh: awtctl through TLS: docker/haproxy.cfg before two awtd, docker/stunnel.conf before one, stunnel beside the client.
# Skips what is not installed (Debian's haproxy, stunnel4, openssl).
set -u
cd "$(dirname "$0")/.."
build=${1:-build/release}
passed=0 failed=0 skipped=0
work=$(mktemp -d /tmp/awtd-tls-XXXXXX)
running=
finish() {
    [ -n "$running" ] && kill $running 2>/dev/null
    wait
    rm -rf "$work"
}
trap finish EXIT
trap 'exit 1' INT TERM HUP
done_with() { echo "$passed passed, $failed failed, $skipped skipped"; exit 0; }
for tool in openssl stunnel python3; do
    command -v $tool >/dev/null 2>&1 || { echo "skip tls: no $tool here"; skipped=1; done_with; }
done

ports=$(python3 -c 'import socket
s=[socket.socket() for _ in range(5)]
[x.bind(("127.0.0.1",0)) for x in s]
print(*[x.getsockname()[1] for x in s])')
set -- $ports
one=$1 two=$2 balanced=$3 terminated=$4 beside=$5
openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -addext subjectAltName=IP:127.0.0.1 \
    -keyout "$work/key" -out "$work/cert" 2>/dev/null
cat "$work/key" "$work/cert" >"$work/pem"
for port in $one $two; do
    "$build/awtd" --listen 127.0.0.1:$port --state-dir "$work/state" >"$work/out.$port" 2>"$work/log.$port" &
    running="$running $!"
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        grep -q '^listening' "$work/out.$port" && break
        sleep 0.2
    done
done

# ping NAME TLS-PORT: stunnel beside the client, which checks the certificate.
ping_through() {
    printf 'foreground = yes\npid =\n[c]\nclient = yes\naccept = 127.0.0.1:%s\nconnect = 127.0.0.1:%s\nCAfile = %s\nverifyChain = yes\ncheckIP = 127.0.0.1\n' \
        $beside $2 "$work/cert" >"$work/client.conf"
    stunnel "$work/client.conf" >"$work/client.log" 2>&1 &
    client=$!
    good=no
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        "$build/awtctl" ping --count 1 --connect 127.0.0.1:$beside --token-file "$work/state/token" >>"$work/ping" 2>&1 && good=yes && break
        sleep 0.2
    done
    kill $client
    wait $client 2>/dev/null
    if [ $good = yes ]; then
        echo "ok   $1"
        passed=$((passed + 1))
    else
        tail -n 5 "$work/ping" "$work/client.log"
        echo "FAIL $1"
        failed=$((failed + 1))
    fi
}

sed "s/0.0.0.0:4690/127.0.0.1:$terminated/; s/127.0.0.1:4680/127.0.0.1:$one/; s|/etc/stunnel/awtd.pem|$work/pem|; s/^foreground.*/&\npid =/" \
    docker/stunnel.conf >"$work/stunnel.conf"
stunnel "$work/stunnel.conf" >"$work/stunnel.log" 2>&1 &
running="$running $!"
ping_through tls_by_stunnel $terminated

if command -v haproxy >/dev/null 2>&1; then
    sed "s/0.0.0.0:4690/127.0.0.1:$balanced/; s/127.0.0.1:4680/127.0.0.1:$one/; s/127.0.0.1:4682/127.0.0.1:$two/; s|/etc/haproxy/awtd.pem|$work/pem|" \
        docker/haproxy.cfg >"$work/haproxy.cfg"
    haproxy -f "$work/haproxy.cfg" >"$work/haproxy.log" 2>&1 &
    running="$running $!"
    ping_through tls_by_haproxy_with_the_routing_key $balanced
else
    echo "skip tls_by_haproxy_with_the_routing_key: no haproxy here"
    skipped=$((skipped + 1))
fi
done_with
