#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "viewer/input.h"

namespace fathom {

/// A place that a script names: pixels of the window; a widget or pane, and where in it; a pixel of the frame shown in
/// Review; a point in space as seen in the Outline pane.
struct ScriptPoint {
  enum class Kind { kWindow, kItem, kImage, kSpace };
  Kind kind = Kind::kWindow;
  std::string item;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
};

/// One thing that a script asks for besides input.
struct ScriptStep {
  enum class Kind {
    kMove,
    kInput,
    kFrames,   ///< draws `count` frames
    kIdle,     ///< draws until no work is under way
    kWait,     ///< draws for `seconds`
    kPicture,  ///< writes `file`: all of the window, or of `item`
    kDump,     ///< writes the model's state to `file`
    kKeys,     ///< writes the table of keys in Markdown to `file`
    kBench,    ///< draws `count` frames and writes to `file` what they cost
    kQuit,     ///< ends at once, without saving or asking
  };
  Kind kind = Kind::kInput;
  ScriptPoint point = {};
  InputEvent input = {};
  int count = 1;
  double seconds = 0.0;
  std::string file = {};
  std::string item = {};
};

/// What a script needs of the program that it drives.
struct ScriptTarget {
  std::function<std::optional<Eigen::Vector2d>(const ScriptPoint&)> find;  ///< empty where it is not shown
  std::function<void(InputEvent)> push;
  std::function<bool()> busy;
  std::function<bool()> queued;  ///< input that no frame has taken yet
  std::function<void(const std::filesystem::path&, const std::string& item)> picture;
  std::function<void(const std::filesystem::path&)> dump;
  std::function<void(const std::filesystem::path&)> keys;
  std::function<void(const std::filesystem::path&, int frames)> bench;
};

/// Replays mouse, key and menu events on the real window (docs/viewer.md).
class Script {
 public:
  /// Files that the script writes are relative to its own folder. Throws Error where it is damaged.
  explicit Script(const std::filesystem::path& file);

  /// Window's size that it was written for.
  int width() const { return width_; }
  int height() const { return height_; }

  /// Called before every frame. Returns false when all is done. Throws Error, naming the step, where something that it
  /// points at does not appear within five seconds.
  bool step(const ScriptTarget& target);
  /// Between two frames: false while it waits for nothing but time.
  bool waits() const { return wait_until_s_ > 0.0; }

 private:
  bool run(const ScriptStep& step, const ScriptTarget& target);
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path file_;
  std::vector<ScriptStep> steps_;
  std::vector<std::size_t> event_of_;  ///< number in the file, of each step
  std::size_t next_ = 0;
  int frames_left_ = 0;
  int idle_frames_ = 0;
  double wait_until_s_ = 0.0;
  double missing_since_s_ = 0.0;
  int width_ = 1280;
  int height_ = 800;
};

/// The steps of a script's file, and of which event each is. Throws Error.
struct ScriptText {
  std::vector<ScriptStep> steps;
  std::vector<std::size_t> event_of;
  int width = 1280;
  int height = 800;
};
ScriptText read_script(const std::filesystem::path& file);

}  // namespace fathom
