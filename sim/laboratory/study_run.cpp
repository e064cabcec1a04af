#include "sim/laboratory/study_run.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "core/error.h"

namespace fathom {

namespace {

constexpr auto kPoll = std::chrono::milliseconds(100);  // so soon is a wish to stop heard

// Cases are spread over threads, so what they call shall not spread over threads again.
class OneThreadEach {
 public:
  OneThreadEach() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OneThreadEach() { cv::setNumThreads(before_); }
  OneThreadEach(const OneThreadEach&) = delete;
  OneThreadEach& operator=(const OneThreadEach&) = delete;

 private:
  int before_;
};

/// The cases that are still to be run, and what came of the others.
class Cases {
 public:
  Cases(const Study& study, const StudyRun& run) : study_(study), options_(run.options) {
    const int count = study.cases(run.options);
    for (int i = run.shard.index; i < count; i += run.shard.count) numbers_.push_back(i);
  }

  std::size_t size() const { return numbers_.size(); }

  /// Runs one case after another until none is left, one has failed or the work is to stop.
  void work() {
    while (const auto number = next()) {
      try {
        // As it will be read from a file: keys in alphabetical order, numbers that are not finite as null.
        const nlohmann::json sorted = study_.run_case(options_, *number);
        keep(*number, nlohmann::ordered_json::parse(sorted.dump()));
      } catch (const std::exception& error) {
        fail(*number, error.what());
      }
    }
    const std::lock_guard lock(mutex_);
    ++ended_;
    changed_.notify_all();
  }

  /// Waits until all of `threads` have ended, and reports.
  void wait(int threads, const Progress& progress) {
    std::unique_lock lock(mutex_);
    while (ended_ < threads) {
      changed_.wait_for(lock, kPoll);
      const double fraction =
          static_cast<double>(values_.size()) / static_cast<double>(std::max<std::size_t>(size(), 1));
      lock.unlock();
      const bool go_on = !progress || progress(fraction);
      lock.lock();
      cancelled_ = cancelled_ || !go_on;
    }
  }

  std::map<int, nlohmann::ordered_json> take() {
    if (failure_) {
      throw Error("study " + study_.name() + ", " + study_.case_name(options_, failure_->first) + ": " +
                  failure_->second);
    }
    if (cancelled_) throw Cancelled();
    return std::move(values_);
  }

 private:
  std::optional<int> next() {
    const std::lock_guard lock(mutex_);
    if (cancelled_ || failure_ || given_ == numbers_.size()) return std::nullopt;
    return numbers_[given_++];
  }

  void keep(int number, nlohmann::ordered_json value) {
    const std::lock_guard lock(mutex_);
    values_.emplace(number, std::move(value));
    changed_.notify_all();
  }

  // Cases are given out in order, so the first that fails is the same however many threads there are.
  void fail(int number, std::string what) {
    const std::lock_guard lock(mutex_);
    if (!failure_ || number < failure_->first) failure_.emplace(number, std::move(what));
    changed_.notify_all();
  }

  const Study& study_;
  StudyOptions options_;
  std::vector<int> numbers_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t given_ = 0;
  int ended_ = 0;
  bool cancelled_ = false;
  std::optional<std::pair<int, std::string>> failure_;
  std::map<int, nlohmann::ordered_json> values_;
};

}  // namespace

void StudyRun::check() const {
  const auto require = [](const char* what, int value, int low, int high) {
    if (value < low || value > high) {
      throw Error("accuracy: the number of " + std::string(what) + " cannot be " + std::to_string(value) +
                  "; choose from " + std::to_string(low) + " to " + std::to_string(high));
    }
  };
  require("samples", options.samples, 1, kMostSamples);
  require("threads", threads, 1, kMostThreads);
  require("shards", shard.count, 1, kMostShards);
  require("shards before this one", shard.index, 0, shard.count - 1);
}

StudyResults run_study(const Study& study, const StudyRun& run, const Progress& progress) {
  run.check();
  const OneThreadEach one_thread_each;
  Cases cases(study, run);
  const int count = std::clamp(static_cast<int>(cases.size()), 1, run.threads);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < count; ++i) threads.emplace_back([&cases] { cases.work(); });
    cases.wait(count, progress);
  }
  StudyResults results;
  results.version = run.version;
  results.build = run.build;
  results.study = study.name();
  results.options = run.options;
  results.cases = study.cases(run.options);
  results.shard = run.shard;
  results.values = cases.take();
  return results;
}

}  // namespace fathom
