/* new_reserve.h: memory set aside for a C++ library that cannot do without: one that allocates in destructors, as
 * tinygltf's JSON does, ends the process where `new` fails. So what it may need is taken before it is called, where to
 * be refused is harmless, and let go when its `new` finds nothing. C++ only. */
#ifndef GEOM_NEW_RESERVE_H
#define GEOM_NEW_RESERVE_H

#include <cstddef>

/* For the calling thread, while it lives; one at a time. A `new` that fails meanwhile gives the reserve back to the
 * heap and tries again; where the reserve was not enough, or another thread was faster, it fails as ever. Other
 * threads' new does as it would without. */
class NewReserve
{
  public:
    explicit NewReserve(std::size_t bytes);
    ~NewReserve();
    NewReserve(const NewReserve &) = delete;
    NewReserve &operator=(const NewReserve &) = delete;

    /* False: there is no memory for it. */
    bool is_there() const;
};

#endif
