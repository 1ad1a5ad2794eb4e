/// Two slots of POSIX shared memory, one for each direction. Each has a turn: odd while the slot is
/// written, and two more after every packet. docs/howto/realtime.md has the places.

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>

#include "hydrapod/base/error.hpp"
#include "transport.hpp"

namespace hydrapod::realtime {

namespace {

constexpr std::uint64_t shared_magic = 0x31304d4853445948;  // "HYDSHM01"
constexpr std::size_t room = 1984;

struct Slot {
  std::uint32_t turn{};
  std::uint32_t size{};
  std::byte padding[56]{};
  std::byte bytes[room]{};
};

struct Segment {
  std::uint64_t magic{};
  std::byte padding[56]{};
  Slot command{};
  Slot sensors{};
};
static_assert(sizeof(Slot) == 2048 && sizeof(Segment) == 64 + 2 * 2048);
static_assert(std::atomic_ref<std::uint32_t>::is_always_lock_free);

class SharedMemory : public Transport {
 public:
  SharedMemory(const std::string& name, bool serves, const std::string& argument)
      : name_(fmt::format("/{}", name)), serves_(serves) {
    if (name.empty() || name.find('/') != name.npos || name.size() > 200)
      base::refuse(argument,
                   fmt::format("'{}' is no name of shared memory, expected a word without "
                               "slashes",
                               name));
    file_ = ::shm_open(name_.c_str(), O_RDWR | O_CLOEXEC | (serves ? O_CREAT : 0), 0600);
    if (file_ < 0) fail(argument, errno);
    // locked by the server as long as it lives, so that what a killed one left is taken over
    if (serves && ::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      ::close(file_);
      base::refuse(argument, fmt::format("another server has the shared memory '{}'", name));
    }
    struct stat status {};
    const bool own = ::fstat(file_, &status) == 0 && status.st_uid == ::geteuid();
    if (serves && (!own || ::ftruncate(file_, sizeof(Segment)) != 0))
      fail(argument, own ? errno : EPERM);
    if (!serves && (!own || status.st_size != sizeof(Segment))) fail(argument, EINVAL);
    void* memory = ::mmap(nullptr, sizeof(Segment), PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    if (memory == MAP_FAILED) fail(argument, errno);
    segment_ = static_cast<Segment*>(memory);
    if (serves) std::memset(memory, 0, sizeof(Segment));
    seen_ = turn_of(incoming()).load(std::memory_order_acquire);
    if (serves) std::atomic_ref(segment_->magic).store(shared_magic, std::memory_order_release);
    if (!serves && segment_->magic != shared_magic) {
      ::munmap(segment_, sizeof(Segment));
      fail(argument, EINVAL);
    }
  }
  ~SharedMemory() override {
    ::munmap(segment_, sizeof(Segment));
    if (serves_) ::shm_unlink(name_.c_str());
    ::close(file_);
  }

  bool receive(Datagram& datagram) override {
    Slot& slot = incoming();
    const std::uint32_t turn = turn_of(slot).load(std::memory_order_acquire);
    if (turn == seen_ || turn % 2 != 0) return false;
    datagram.size = std::min<std::size_t>(slot.size, room);  // it is the other's to write
    std::memcpy(datagram.bytes.data(), slot.bytes, datagram.size);
    std::atomic_thread_fence(std::memory_order_acquire);
    if (turn_of(slot).load(std::memory_order_relaxed) != turn) return false;  // being written anew
    seen_ = turn;
    datagram.peer = {};
    return true;
  }

  void wait(double seconds) override {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    constexpr timespec nap{.tv_sec = 0, .tv_nsec = 50'000};
    while (turn_of(incoming()).load(std::memory_order_acquire) == seen_ && Clock::now() < end)
      ::nanosleep(&nap, nullptr);
  }

  bool send(std::span<const std::byte> bytes, const Peer&) override {
    Slot& slot = serves_ ? segment_->sensors : segment_->command;
    const std::uint32_t turn = turn_of(slot).load(std::memory_order_relaxed) | 1U;
    turn_of(slot).store(turn, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    slot.size = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(slot.bytes, bytes.data(), bytes.size());
    turn_of(slot).store(turn + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::string place() const override { return "/dev/shm" + name_; }

 private:
  [[noreturn]] void fail(const std::string& argument, int cause) {
    if (file_ >= 0) ::close(file_);
    base::refuse(argument, fmt::format("the shared memory '{}' cannot be {}: {}", name_.substr(1),
                                       serves_ ? "made" : "opened",
                                       cause == EINVAL ? "it is not that of `hydrapod serve`"
                                                       : std::strerror(cause)));
  }
  static std::atomic_ref<std::uint32_t> turn_of(Slot& slot) { return std::atomic_ref(slot.turn); }
  Slot& incoming() { return serves_ ? segment_->command : segment_->sensors; }

  std::string name_;
  bool serves_;
  int file_{-1};
  Segment* segment_{};
  std::uint32_t seen_{};
};

}  // namespace

std::unique_ptr<Transport> open_shared_memory(const std::string& name, bool serves,
                                              const std::string& argument) {
  return std::make_unique<SharedMemory>(name, serves, argument);
}

}  // namespace hydrapod::realtime
