/* member.c: see member.h. */
#include "load/member.h"

#include "load/wait.h"

load_mode member_mode(const member *m, uint32_t slice)
{
    return (load_mode)m->run->line.modes[slice];
}

bool member_sent(member *m, uint64_t request, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    if (m->waiting_count == MEMBER_WAITING) {
        book_error(&m->run->book, "%d requests of one connection wait for an answer", MEMBER_WAITING);
        return false;
    }
    m->waiting[m->waiting_count++] = (member_due){request, due_ns, now_ns, slice};
    return true;
}

bool member_answered(member *m, uint64_t request, member_due *due)
{
    for (uint32_t i = 0; i < m->waiting_count; i++) {
        if (m->waiting[i].request == request) {
            *due = m->waiting[i];
            m->waiting[i] = m->waiting[--m->waiting_count];
            return true;
        }
    }
    return false;
}

void member_next(member *m)
{
    const timeline *line = &m->run->line;
    const int64_t now_ns = wait_now_ns(), at_ns = now_ns - m->run->begin_ns;
    const uint32_t slice = timeline_slice_at(line, at_ns);
    if (m->run->plan->closed && slice < line->slices && timeline_side(member_mode(m, slice)) == m->side &&
        at_ns - slice * line->slice_ns < line->busy_ns) {
        m->face->due(m, slice, now_ns, now_ns);
    }
}
