#pragma once
/// Ctrl-C as a wish to stop, not as an end: long work looks, and leaves what it has.

#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// While one exists, the first SIGINT or SIGTERM is only noted; a second one ends the program as
/// usual. One at a time.
class InterruptNote {
 public:
  InterruptNote();
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;

  [[nodiscard]] static bool noted();

 private:
  void (*before_interrupt_)(int);
  void (*before_terminate_)(int);
};

/// What `task` makes, with a progress line titled `title`. Ctrl-C asks the task to stop.
template <class Task>
auto with_progress(const char* title, const Task& task) {
  const InterruptNote interrupt;
  ProgressLine line(title);
  return task(numerics::Progress([&](double share) {
    line.update(share);
    return InterruptNote::noted();
  }));
}

}  // namespace hydrapod::cli
