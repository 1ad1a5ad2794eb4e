#pragma once
/// Ctrl-C as a wish to stop, not as an end: long work looks, and leaves what it has.

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

}  // namespace hydrapod::cli
