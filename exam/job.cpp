#include "exam/job.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace fathom {

struct Worker::Task {
  Job job;
  bool running = false;  // guarded by Worker::mutex_, as are the next two
  std::function<void()> deliver;
  std::string error;
  std::atomic<bool> cancelled = false;
  std::atomic<double> fraction = 0.0;
};

Worker::Worker(int threads) {
  for (int i = 0; i < std::max(1, threads); ++i) threads_.emplace_back([this] { run(); });
}

Worker::~Worker() {
  cancel_all();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Worker::start(Job job) {
  auto task = std::make_shared<Task>();
  task->job = std::move(job);
  std::shared_ptr<Task> replaced;  // destroyed outside of the lock
  {
    const std::lock_guard lock(mutex_);
    const auto waiting = std::find_if(tasks_.begin(), tasks_.end(), [&](const auto& other) {
      return !other->running && other->job.key == task->job.key;
    });
    if (waiting != tasks_.end()) {
      replaced = std::exchange(*waiting, std::move(task));
    } else {
      tasks_.push_back(std::move(task));
    }
  }
  wake_.notify_all();
}

void Worker::cancel(const std::string& key) {
  std::vector<std::shared_ptr<Task>> dropped;
  const std::lock_guard lock(mutex_);
  for (const auto* list : {&tasks_, &finished_}) {
    for (const auto& task : *list) {
      if (task->job.key == key) task->cancelled = true;
    }
  }
  drop_cancelled(dropped);
}

void Worker::cancel_all() {
  std::vector<std::shared_ptr<Task>> dropped;  // destroyed outside of the lock
  const std::lock_guard lock(mutex_);
  for (const auto* list : {&tasks_, &finished_}) {
    for (const auto& task : *list) task->cancelled = true;
  }
  drop_cancelled(dropped);
}

// Of those that wait; the caller holds the lock.
void Worker::drop_cancelled(std::vector<std::shared_ptr<Task>>& dropped) {
  const auto gone = [](const auto& task) { return task->cancelled && !task->running; };
  std::copy_if(tasks_.begin(), tasks_.end(), std::back_inserter(dropped), gone);
  std::erase_if(tasks_, gone);
}

std::shared_ptr<Worker::Task> Worker::next_task() {
  for (const auto& task : tasks_) {
    if (task->running) continue;
    const bool busy = std::any_of(tasks_.begin(), tasks_.end(),
                                  [&](const auto& other) { return other->running && other->job.key == task->job.key; });
    if (!busy) return task;
  }
  return nullptr;
}

void Worker::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    std::shared_ptr<Task> task;
    wake_.wait(lock, [&] { return stopping_ || (task = next_task()) != nullptr; });
    if (stopping_) return;
    task->running = true;
    lock.unlock();
    std::function<void()> deliver;
    std::string error;
    try {
      deliver = task->job.work([&](double fraction) {
        task->fraction = fraction;
        return !task->cancelled;
      });
    } catch (const Cancelled&) {
      task->cancelled = true;
    } catch (const std::exception& fault) {
      error = fault.what();
    }
    lock.lock();
    task->running = false;
    task->deliver = std::move(deliver);
    task->error = std::move(error);
    std::erase(tasks_, task);
    finished_.push_back(std::move(task));
    wake_.notify_all();  // one of the same key may have waited
    delivered_.notify_all();
  }
}

int Worker::poll() {
  int count = 0;
  // One by one: what is delivered may cancel others, or take long.
  for (;;) {
    std::shared_ptr<Task> task;
    {
      const std::lock_guard lock(mutex_);
      if (finished_.empty()) return count;
      task = std::move(finished_.front());
      finished_.erase(finished_.begin());
    }
    if (task->cancelled) continue;
    if (!task->error.empty()) {
      if (task->job.failed) task->job.failed(task->error);
    } else if (task->deliver) {
      task->deliver();
    }
    ++count;
  }
}

std::vector<JobStatus> Worker::jobs() const {
  const std::lock_guard lock(mutex_);
  std::vector<JobStatus> list;
  for (const auto& task : tasks_) {
    list.push_back({task->job.key, task->job.title, task->running, task->fraction, task->cancelled});
  }
  return list;
}

void Worker::finish() {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      delivered_.wait(lock, [&] { return !finished_.empty() || tasks_.empty(); });
      if (finished_.empty()) return;
    }
    poll();
  }
}

}  // namespace fathom
