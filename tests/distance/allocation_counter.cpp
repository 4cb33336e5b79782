// Counts every allocation of the executable that it is linked into. A file of its own: inlined into its callers,
// the pair of operators would look mismatched to the compiler.
#include <cstdlib>
#include <new>

extern long allocation_count;
long allocation_count = 0;

void* operator new(std::size_t size) {
  ++allocation_count;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocation_count;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
