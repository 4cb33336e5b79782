#include "solver/engine/call_conditions.hpp"

#include <omp.h>

#include <algorithm>

namespace scree {

CallConditions::CallConditions(int threads)
    : threads_before_(omp_get_max_threads()), is_dynamic_before_(omp_get_dynamic()), threads_(std::max(1, threads)) {
  omp_set_dynamic(0);
  omp_set_num_threads(threads_);
  environments_.resize(static_cast<std::size_t>(threads_));
  if (threads_ == 1) {
    std::fegetenv(environments_.data());
    std::fesetenv(FE_DFL_ENV);  // on x86 it also turns off flush-to-zero and denormals-are-zero
    return;
  }
#pragma omp parallel num_threads(threads_)
  {
    std::fegetenv(&environments_[static_cast<std::size_t>(omp_get_thread_num())]);
    std::fesetenv(FE_DFL_ENV);
  }
}

void CallConditions::leave() {
  threads_ = omp_get_max_threads();  // a run may take more or fewer
  omp_set_num_threads(threads_before_);
  omp_set_dynamic(is_dynamic_before_);
  std::fesetenv(environments_.data());
}

void CallConditions::enter() {
  threads_before_ = omp_get_max_threads();
  is_dynamic_before_ = omp_get_dynamic();
  std::fegetenv(environments_.data());
  omp_set_dynamic(0);
  omp_set_num_threads(threads_);
  std::fesetenv(FE_DFL_ENV);
}

CallConditions::~CallConditions() {
  const auto threads = static_cast<int>(environments_.size());
  if (threads == 1) {
    std::fesetenv(environments_.data());
  } else {
#pragma omp parallel num_threads(threads)
    std::fesetenv(&environments_[static_cast<std::size_t>(omp_get_thread_num())]);
  }
  omp_set_num_threads(threads_before_);
  omp_set_dynamic(is_dynamic_before_);
}

}  // namespace scree
