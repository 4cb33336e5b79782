#include "solver/ranks/agreement.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace scree {

namespace {

extern "C" void combine_reports(void* in, void* in_out, int* length, MPI_Datatype* /*type*/) {
  const auto* from = static_cast<const StepReport*>(in);
  auto* to = static_cast<StepReport*>(in_out);
  for (int i = 0; i < *length; ++i, ++from, ++to) {
    to->rebuild = std::max(to->rebuild, from->rebuild);
    to->signal = std::max(to->signal, from->signal);
    to->failed = std::max(to->failed, from->failed);
    to->checkpoint = std::max(to->checkpoint, from->checkpoint);
    to->largest_work = std::max(to->largest_work, from->largest_work);
    to->cut_cost = std::max(to->cut_cost, from->cut_cost);
    to->fastest = std::max(to->fastest, from->fastest);
    to->work += from->work;  // whole numbers: the same sum on every rank, so that all decide alike
  }
}

}  // namespace

Agreement::Agreement(const mpi::Communicator& comm) : comm_(comm), buffers_(std::make_unique<Buffers>()) {
  MPI_Type_contiguous(static_cast<int>(sizeof(StepReport)), MPI_BYTE, &type_);
  MPI_Type_commit(&type_);
  MPI_Op_create(combine_reports, 1, &op_);
}

Agreement::~Agreement() {
  // Open MPI crashes when a communicator ends before its reductions do. After an exception that the other ranks know nothing
  // of they may never take part: then the job is stopped, and what is under way keeps its buffers.
  if (is_under_way()) {
    if (std::uncaught_exceptions() == 0)
      MPI_Wait(&request_, MPI_STATUS_IGNORE);
    else
      static_cast<void>(buffers_.release());
  }
  MPI_Op_free(&op_);
  MPI_Type_free(&type_);
}

void Agreement::start(const StepReport& mine) {
  SCREE_ASSERT(!is_under_way());
  buffers_->mine = mine;
  MPI_Iallreduce(&buffers_->mine, &buffers_->all, 1, type_, op_, comm_.get(), &request_);
}

StepReport Agreement::finish() {
  SCREE_ASSERT(is_under_way());
  MPI_Wait(&request_, MPI_STATUS_IGNORE);
  return buffers_->all;
}

void Agreement::finish_early() {
  if (is_under_way()) early_ = finish();
}

StepReport Agreement::take() {
  finish_early();
  return std::exchange(early_, std::nullopt).value();
}

}  // namespace scree
