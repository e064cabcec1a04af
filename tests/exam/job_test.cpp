#include "exam/job.h"

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/exam/held_work.h"

namespace fathom {
namespace {

TEST(Jobs, DeliverOnTheThreadThatPolls) {
  Worker worker;
  const auto here = std::this_thread::get_id();
  std::thread::id worked;
  std::thread::id delivered;
  worker.start({"a",
                "A",
                [&](const Progress&) -> std::function<void()> {
                  worked = std::this_thread::get_id();
                  return [&] { delivered = std::this_thread::get_id(); };
                },
                {}});
  worker.finish();
  EXPECT_NE(worked, here);
  EXPECT_EQ(delivered, here);
  EXPECT_TRUE(worker.idle());
}

TEST(Jobs, OfOneKeyOnlyTheNewestWaits) {
  Worker worker(2);
  std::atomic<bool> go = false;
  std::atomic<bool> begun = false;
  std::vector<int> delivered;
  const auto job = [&](int number) -> Job {
    return {"surface",
            "Surface",
            [&, number](const Progress&) -> std::function<void()> {
              begun = true;
              while (!go) std::this_thread::yield();
              return [&, number] { delivered.push_back(number); };
            },
            {}};
  };
  worker.start(job(0));
  while (!begun) std::this_thread::yield();
  for (int i = 1; i <= 100; ++i) worker.start(job(i));
  EXPECT_EQ(worker.jobs().size(), 2u) << "one runs, one waits";
  go = true;
  worker.finish();
  EXPECT_EQ(delivered, (std::vector{0, 100}));
}

TEST(Jobs, CanBeCancelledAndSayWhatWentWrong) {
  Worker worker;
  std::atomic<bool> begun = false;
  bool delivered = false;
  std::string fault;
  worker.start({"long", "Long",
                [&](const Progress& progress) -> std::function<void()> {
                  for (;;) {
                    report(progress, 0.25);
                    begun = true;
                  }
                },
                [&](const std::string&) { delivered = true; }});
  while (!begun) std::this_thread::yield();
  ASSERT_EQ(worker.jobs().size(), 1u);
  EXPECT_EQ(worker.jobs()[0].fraction, 0.25);
  worker.cancel("long");
  worker.finish();
  EXPECT_FALSE(delivered) << "cancelled is no fault";
  worker.start({"bad", "Bad", [](const Progress&) -> std::function<void()> { throw Error("scan.mha: is damaged"); },
                [&](const std::string& error) { fault = error; }});
  worker.finish();
  EXPECT_EQ(fault, "scan.mha: is damaged");
}

TEST(Jobs, CancelledInMidWorkTheyAreToldSoAndDeliverNothing) {
  for (const bool looks : {true, false}) {
    for (const bool all : {true, false}) {
      HeldWork held;
      HeldWork waiting;
      held.looks = looks;
      waiting.go.open();
      Worker worker;
      worker.start(held.job("surface"));
      held.begun.wait();
      worker.start(waiting.job("surface"));
      all ? worker.cancel_all() : worker.cancel("surface");
      ASSERT_EQ(worker.jobs().size(), 1u) << "the one that waits is gone at once";
      EXPECT_TRUE(worker.jobs()[0].cancelling);
      held.go.open();
      worker.finish();
      EXPECT_EQ(held.stopped, looks);
      EXPECT_FALSE(held.delivered);
      EXPECT_FALSE(waiting.delivered);
      EXPECT_TRUE(worker.idle());
    }
  }
}

TEST(Jobs, CancelledWhenDoneTheyDeliverNothing) {
  for (const bool all : {true, false}) {
    HeldWork held;
    held.go.open();
    Worker worker;
    worker.start(held.job("surface"));
    wait_until_done(worker);
    all ? worker.cancel_all() : worker.cancel("surface");
    EXPECT_EQ(worker.poll(), 0);
    EXPECT_FALSE(held.delivered);
  }
}

}  // namespace
}  // namespace fathom
