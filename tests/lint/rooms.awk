# rooms.awk: reads the compiler's dependency files and refuses a header that a room may not include.
# core sees core; proto sees proto; server sees core and proto, but of core neither groom/ nor sim/; clients see
# proto and, of core, base/, awt.h (types), geom/read.h and geom/receive.h.
function room(path) { return substr(path, 1, index(path, "/") - 1) }
function allowed(from, header) {
    to = room(header)
    if (from == to) return 1
    if (from == "server") return to == "proto" || header ~ /^core\/(awt\.h|base\/|geom\/(encode|read)\.h)/
    if (from == "clients") return to == "proto" || header ~ /^core\/(awt\.h|base\/|geom\/(read|receive)\.h)/
    return 0
}
FNR == 1 { source = "" }
{
    for (i = 1; i <= NF; i++) {
        word = $i
        if (word == "\\" || word ~ /:$/ || word ~ /^\//) continue
        if (word ~ /\.cc?$/ && source == "") { source = word; continue }
        if (word !~ /\.(h|def)$/) continue
        if (word ~ /^(core|proto|server|clients|tests)\// && !allowed(room(source), word)) {
            printf "%s may not include %s\n", source, word > "/dev/stderr"
            bad = 1
        }
    }
}
END { exit bad }
