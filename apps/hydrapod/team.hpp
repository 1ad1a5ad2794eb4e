#pragma once
/// Ranks of MPI as a team. Loaded where the program was started by mpirun or srun; what MPI needs
/// is in a shared object beside the program (apps/mpi).

#include <exception>
#include <memory>
#include <optional>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::cli {

/// The ranks of this job; none where the program was started alone. Ranks other than 0 print no
/// warnings and no notes from here on. Throws base::ComputationError where the program was started
/// by mpirun and has no MPI, or another one.
std::unique_ptr<study::Team> team_of_ranks();

/// Whether this is a rank other than 0 that has no team yet: what is wrong with the command line of
/// the study `command` is then said by rank 0, which has the same one.
bool is_said_by_rank_0(std::string_view command);

/// For a rank that ends because of what another rank says: waits until that rank has ended, and
/// mpirun then ends this one, or for 3 s. An mpirun kills all others when the first one fails: the
/// message would be lost.
void wait_for_the_rank_that_says_why();

/// What `work` makes, on each rank. Where it fails on any, it fails on all, and the first of them
/// says why.
template <class Work>
auto together(study::Team* team, const Work& work) -> decltype(work()) {
  if (team == nullptr) return work();
  std::optional<decltype(work())> made;
  std::exception_ptr failure;
  try {
    made.emplace(work());
  } catch (...) {
    failure = std::current_exception();
  }
  const auto first = team->least(failure ? team->rank() : team->size());
  if (first == team->size()) return std::move(*made);
  if (first == team->rank()) std::rethrow_exception(failure);
  throw base::InputError({});
}

}  // namespace hydrapod::cli
