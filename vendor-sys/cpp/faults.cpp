// For tests: injects failures into all C++ allocations of the process.

#include <cstdlib>
#include <new>

extern "C" bool qless_fails_on_purpose();

namespace
{

void *allocated(std::size_t size)
{
    void *block = qless_fails_on_purpose() ? nullptr : std::malloc(size ? size : 1);
    if (!block)
        throw std::bad_alloc();
    return block;
}

} // namespace

void *operator new(std::size_t size)
{
    return allocated(size);
}

void *operator new[](std::size_t size)
{
    return allocated(size);
}

void operator delete(void *block) noexcept
{
    std::free(block);
}

void operator delete[](void *block) noexcept
{
    std::free(block);
}

void operator delete(void *block, std::size_t) noexcept
{
    std::free(block);
}

void operator delete[](void *block, std::size_t) noexcept
{
    std::free(block);
}
