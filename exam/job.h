#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/progress.h"

namespace fathom {

/// Long work to be done beside the main thread.
struct Job {
  std::string key;    ///< two of the same key never run at once, and a newer one takes the place of one that waits
  std::string title;  ///< "Surface of bladder", beside the bar
  /// Runs on another thread; what it returns, if anything, is called by poll on the main thread.
  std::function<std::function<void()>(const Progress&)> work;
  /// Called by poll on the main thread when the work threw; not when it was cancelled.
  std::function<void(const std::string& error)> failed;
};

struct JobStatus {
  std::string key;
  std::string title;
  bool running = false;   ///< else it waits
  double fraction = 0.0;  ///< done, in [0, 1]
  bool cancelling = false;
};

/// Threads that do jobs one after another, in the order in which they were started. All functions are for one thread,
/// the main one.
class Worker {
 public:
  explicit Worker(int threads = 1);
  /// Cancels everything and waits until the running jobs have noticed.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Takes the place of a job of the same key that waits; one that runs goes on, and this one comes after it.
  void start(Job job);
  /// The running and the waiting job of this key, and one that is done but not delivered: nothing of them is delivered
  /// any more, though a running one may go on until it next reports.
  void cancel(const std::string& key);
  /// The same for all keys.
  void cancel_all();

  /// Calls what finished jobs have to deliver. Returns how many did. Never waits for work.
  int poll();
  /// Those that run or wait, in the order of their start.
  std::vector<JobStatus> jobs() const;
  bool idle() const { return jobs().empty(); }
  /// Polls until nothing runs or waits: for tests and the command line.
  void finish();

 private:
  struct Task;
  void run();
  std::shared_ptr<Task> next_task();
  void drop_cancelled(std::vector<std::shared_ptr<Task>>& dropped);

  mutable std::mutex mutex_;
  std::condition_variable wake_;                 // for the threads
  std::condition_variable delivered_;            // for finish()
  std::vector<std::shared_ptr<Task>> tasks_;     // running and waiting
  std::vector<std::shared_ptr<Task>> finished_;  // to be delivered
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace fathom
