#include "hydrapod/team.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <poll.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "hydrapod/terminal.hpp"
#include "mpi/ranks.hpp"

namespace hydrapod::cli {

namespace {

namespace fs = std::filesystem;

/// Ranks that mpirun or srun says it has started; 0: neither started this program.
int ranks_announced() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* text = std::getenv(name)) return std::atoi(text);
  constexpr int unknown = 2;  // more than one
  return std::getenv("PMIX_RANK") != nullptr ? unknown : 0;
}

/// From the folder of the program upwards: a build folder has apps/mpi, an installation a folder
/// hydrapod in that of its libraries.
std::string object_file() {
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  for (fs::path folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
    for (const auto& inside : {fs::path("apps/mpi"), fs::path(HYDRAPOD_PLUGIN_FOLDER)})
      if (const auto file = folder / inside / "hydrapod_mpi.so"; fs::is_regular_file(file, none))
        return file.string();
  return {};
}

bool has_team = false;

[[noreturn]] void no_mpi(const std::string& why) {
  throw base::ComputationError(
      fmt::format("started by mpirun, but {}; without MPI, --shard i/n computes part i of n, and "
                  "--no-mpi runs alone",
                  why));
}

template <class Function>
Function* symbol(void* object, const char* name) {
  void* found = ::dlsym(object, name);
  if (found == nullptr) no_mpi(fmt::format("its hydrapod_mpi.so has no {}", name));
  return reinterpret_cast<Function*>(found);
}

class MpiTeam : public study::Team {
 public:
  explicit MpiTeam(void* object)
      : least_(symbol<decltype(hydrapod_mpi_least)>(object, "hydrapod_mpi_least")),
        ask_(symbol<decltype(hydrapod_mpi_ask)>(object, "hydrapod_mpi_ask")),
        answer_(symbol<decltype(hydrapod_mpi_answer)>(object, "hydrapod_mpi_answer")),
        end_(symbol<decltype(hydrapod_mpi_end)>(object, "hydrapod_mpi_end")) {
    const auto begin = symbol<decltype(hydrapod_mpi_begin)>(object, "hydrapod_mpi_begin");
    if (begin(&rank_, &size_) != 0) no_mpi("MPI does not begin");
    there_ = true;
  }
  ~MpiTeam() override { MpiTeam::leave(); }
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  std::int64_t least(std::int64_t value) override { return least_(value); }
  std::int64_t ask(std::int64_t request) override { return ask_(request); }
  bool answer(const std::function<std::int64_t(std::int64_t)>& reply) override {
    const auto call = [](std::int64_t request, void* with) {
      return (*static_cast<const std::function<std::int64_t(std::int64_t)>*>(with))(request);
    };
    return answer_(call, const_cast<std::function<std::int64_t(std::int64_t)>*>(&reply)) != 0;
  }
  void leave() override {
    if (there_) end_();
    there_ = false;
  }

 private:
  decltype(hydrapod_mpi_least)* least_;
  decltype(hydrapod_mpi_ask)* ask_;
  decltype(hydrapod_mpi_answer)* answer_;
  decltype(hydrapod_mpi_end)* end_;
  int rank_{}, size_{1};
  bool there_{};
};

}  // namespace

bool is_said_by_rank_0(std::string_view command) {
  if (has_team || (command != "montecarlo" && command != "sweep" && command != "map")) return false;
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"})
    if (const char* text = std::getenv(name)) return std::atoi(text) > 0;
  return false;
}

void wait_for_the_rank_that_says_why() {
  constexpr int longest = 3000;  // ms
  ::poll(nullptr, 0, longest);
}

std::unique_ptr<study::Team> team_of_ranks() {
  const int announced = ranks_announced();
  if (announced < 2) return {};
  const auto path = object_file();
  if (path.empty()) no_mpi("this program was built without MPI (Debian: libopenmpi-dev)");
  // Components of Open MPI look for the library among what is visible to all.
  void* object = ::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (object == nullptr) no_mpi(fmt::format("MPI cannot be loaded: {}", ::dlerror()));
  auto team = std::make_unique<MpiTeam>(object);
  if (team->size() < 2)
    no_mpi("it is that of another MPI than the one of this program: each rank finds itself alone");
  has_team = true;
  be_piped();
  if (team->rank() > 0) be_silent();
  return team;
}

}  // namespace hydrapod::cli
