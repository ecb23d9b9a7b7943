/* heap_seam_new.cc: C++'s heap is C's, so that what libdraco and tinygltf take goes through heap_seam.h as well. The
 * other forms of new and delete are the library's, which come here. */
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

void operator delete(void *block) noexcept
{
    std::free(block);
}

void operator delete(void *block, std::size_t) noexcept
{
    std::free(block);
}
