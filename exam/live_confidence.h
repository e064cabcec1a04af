#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "exam/confidence.h"
#include "exam/document.h"
#include "exam/job.h"

namespace fathom {

/// What is known of how far a structure's volume can be trusted.
struct LiveConfidence {
  Confidence confidence;
  std::string fault;           ///< why nothing is known; empty where it is, or is being found out
  bool cancelled = false;      ///< nothing will be known until the structure changes
  std::uint64_t revision = 0;  ///< Document::result_revision that all this is of
};

/// Intervals, where to outline next and missing ends of a document's structures, found out beside the main thread, as
/// they need the volume again for every parameter of the calibration. For the main thread.
class LiveConfidences {
 public:
  /// Both must live as long.
  LiveConfidences(const Document& document, Worker& worker) : document_(document), worker_(worker) {}
  /// Cancels what is under way.
  ~LiveConfidences();
  LiveConfidences(const LiveConfidences&) = delete;
  LiveConfidences& operator=(const LiveConfidences&) = delete;

  /// Starts a job for every structure of which another state is known than the document's. They arrive by Worker::poll.
  /// The errors of outlines and tracker are those that `fathom measure` assumes unless told otherwise.
  void request();
  /// What arrived last; to be shown only where its revision is the document's.
  const LiveConfidence& of(std::size_t structure) { return item(structure).known; }
  /// Stops the job under way, if there is one.
  void cancel(std::size_t structure);

 private:
  struct Item {
    LiveConfidence known;
    std::uint64_t requested = 0;  ///< what the newest job is of
    std::string key;
  };
  Item& item(std::size_t structure);
  void start(std::size_t structure, Item& item, std::uint64_t revision);

  const Document& document_;
  Worker& worker_;
  std::map<std::uint64_t, std::shared_ptr<Item>> items_;  ///< by the structure's id
};

}  // namespace fathom
