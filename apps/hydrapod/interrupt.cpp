#include "hydrapod/interrupt.hpp"

#include <csignal>

namespace hydrapod::cli {

namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void note_interrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

InterruptNote::InterruptNote() {
  interrupted = 0;
  before_interrupt_ = std::signal(SIGINT, note_interrupt);
  before_terminate_ = std::signal(SIGTERM, note_interrupt);
}

InterruptNote::~InterruptNote() {
  std::signal(SIGINT, before_interrupt_);
  std::signal(SIGTERM, before_terminate_);
}

bool InterruptNote::noted() { return interrupted != 0; }

}  // namespace hydrapod::cli
