#pragma once

#include <future>
#include <string>
#include <thread>

#include "exam/job.h"

namespace fathom {

// Held until it is let go, so that nothing depends on who is quicker.
class Latch {
 public:
  void open() { open_.set_value(); }
  void wait() const { opened_.wait(); }

 private:
  std::promise<void> open_;
  std::shared_future<void> opened_ = open_.get_future().share();
};

// Work that tells when it has begun, goes on when it may, and then either looks at whether it should stop or does not.
struct HeldWork {
  Latch begun;
  Latch go;
  bool looks = true;
  bool stopped = false;
  bool delivered = false;

  Job job(const std::string& key) {
    return {key, "Held",
            [this](const Progress& progress) -> std::function<void()> {
              begun.open();
              go.wait();
              if (looks) {
                stopped = !progress(0.5);
                if (stopped) throw Cancelled();
              }
              return [this] { delivered = true; };
            },
            [this](const std::string&) { delivered = true; }};
  }
};

inline void wait_until_done(const Worker& worker) {
  while (!worker.idle()) std::this_thread::yield();
}

}  // namespace fathom
