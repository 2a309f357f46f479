#include "threelink_agent/training/blas.hpp"

#include <algorithm>
#include <climits>
#include <cstdlib>

#include <ATen/Parallel.h>
#include <dlfcn.h>

namespace threelink_agent {
namespace {

// A function that the process has loaded under this name, or null.
template <class Function>
Function* loaded(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

Blas blas_in_use() {
  // The matrix product that LibTorch calls is the first of that name; the file behind the link
  // tells Debian's alternatives apart.
  Dl_info info;
  if (dladdr(dlsym(RTLD_DEFAULT, "sgemm_"), &info) == 0) return {"unknown", "", false};
  char path[PATH_MAX];
  const std::string library = realpath(info.dli_fname, path) ? path : info.dli_fname;
  if (contains(library, "openblas")) {
    const auto corename = loaded<char*()>("openblas_get_corename");
    return {library, corename ? corename() : "", false};
  }
  const bool tuned =
      contains(library, "mkl") || contains(library, "blis") || contains(library, "atlas");
  return {library, "", !tuned};
}

void use_one_thread_per_operation() {
  at::set_num_threads(1);
  if (const auto set = loaded<void(int)>("openblas_set_num_threads")) set(1);
}

}  // namespace threelink_agent
