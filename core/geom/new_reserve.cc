/* new_reserve.cc: see new_reserve.h. The handler stands for good once it was set, for another thread may be in it. */
#include "geom/new_reserve.h"

#include <cstdlib>
#include <new>

namespace
{

thread_local void *reserve;
std::new_handler handler_before;

void release()
{
    std::free(reserve);
    reserve = nullptr;
}

void on_failure()
{
    if (reserve) {
        release();
    } else if (handler_before) {
        handler_before();
    } else {
        throw std::bad_alloc();
    }
}

bool set_handler()
{
    handler_before = std::set_new_handler(on_failure);
    return true;
}

} // namespace

NewReserve::NewReserve(std::size_t bytes)
{
    static const bool is_set = set_handler();
    (void)is_set;
    reserve = std::malloc(bytes);
}

NewReserve::~NewReserve()
{
    release();
}

bool NewReserve::is_there() const
{
    return reserve != nullptr;
}
