/* heap_seam_new.cc: C++'s heap is C's, so that what libdraco and tinygltf take goes through heap_seam.h as well. Every
 * form of new and delete that they use is here: one left to the library is left to a sanitizer where there is one,
 * which then sees what was taken from it given back to another. */
#include <cstdlib>
#include <new>

void *operator new(std::size_t size)
{
    for (;;) {
        void *block = std::malloc(size > 0 ? size : 1);
        if (block) {
            return block;
        }
        const std::new_handler handler = std::get_new_handler();
        if (!handler) {
            throw std::bad_alloc();
        }
        handler();
    }
}

void *operator new(std::size_t size, const std::nothrow_t &) noexcept
{
    return std::malloc(size > 0 ? size : 1);
}

void *operator new[](std::size_t size)
{
    return operator new(size);
}

void *operator new[](std::size_t size, const std::nothrow_t &tag) noexcept
{
    return operator new(size, tag);
}

void operator delete(void *block) noexcept
{
    std::free(block);
}

void operator delete(void *block, std::size_t) noexcept
{
    std::free(block);
}

void operator delete(void *block, const std::nothrow_t &) noexcept
{
    std::free(block);
}

void operator delete[](void *block) noexcept
{
    std::free(block);
}

void operator delete[](void *block, std::size_t) noexcept
{
    std::free(block);
}

void operator delete[](void *block, const std::nothrow_t &) noexcept
{
    std::free(block);
}
