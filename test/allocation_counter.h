#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

// Replaces the operators of the whole program that includes this, in one of its files: what is counted is what the
// library asks for.
namespace saw_ndt {
inline std::atomic<std::size_t> allocation_count{0};
inline std::atomic<std::size_t> allocated_bytes{0};
}  // namespace saw_ndt

void* operator new(std::size_t size) {
  ++saw_ndt::allocation_count;
  saw_ndt::allocated_bytes += size;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
