// Arrays of a megabyte and more in pages of 2 MB where Linux allows them (transparent huge pages by request, Debian's
// setting): environment maps, meshes and octrees are read at random, and each page of 4 KB needs its own entry of the
// address cache. Replaces the global operator new; what it returns can be freed by any operator delete of libstdc++.
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

// The sanitizers have their own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

constexpr size_t kHugePage = size_t(2) << 20, kLargeArray = size_t(1) << 20;

void *Allocate(size_t bytes) {
    if (bytes < kLargeArray) return std::malloc(bytes > 0 ? bytes : 1);
    if (bytes > SIZE_MAX - kHugePage) return nullptr;
    const size_t whole = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    void *p = std::aligned_alloc(kHugePage, whole);
    if (p) madvise(p, whole, MADV_HUGEPAGE);  // a request: ordinary pages are as good
    return p;
}

}  // namespace

void *operator new(size_t bytes) {
    for (;;) {
        if (void *p = Allocate(bytes)) return p;
        const std::new_handler handler = std::get_new_handler();
        if (!handler) throw std::bad_alloc();
        handler();
    }
}
void operator delete(void *p) noexcept { std::free(p); }
void operator delete(void *p, size_t) noexcept { std::free(p); }

#endif
