#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "viewer/input.h"

struct GLFWwindow;

namespace fathom {

struct WindowOptions {
  int width = 1280;
  int height = 800;
  std::string title = "Fathom";
  float scale = 0.0F;  ///< of texts and widgets; 0: as the display asks
  bool dark = true;
  bool scripted = false;  ///< input comes from a script: what the hand does is passed over, and nothing waits for vsync
};

/// The one window of the program with OpenGL and Dear ImGui in it. All input goes through its queue, so that a script's
/// events take the very way of the user's.
class Window {
 public:
  /// Throws Error where there is no display, or none with OpenGL 3.3.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void push(InputEvent event) { queue_.push_back(std::move(event)); }
  bool has_input() const { return !queue_.empty(); }

  /// Waits at most so long for input where there is none.
  void wait(double seconds);
  /// Takes input from the queue, up to one press or release of anything, and begins a frame.
  void begin_frame();
  /// Draws the frame. Without `show` it is only worked out.
  void end_frame();

  /// What begin_frame took: all places of the pointer on the way, newest last; files dropped; whether to close.
  const std::vector<Eigen::Vector2d>& pointer_path() const { return pointer_path_; }
  std::vector<std::string> take_dropped();
  bool close_asked() const { return close_asked_; }
  void refuse_close() { close_asked_ = false; }

  /// The last frame that was drawn, or a part of it: 8-bit BGR. Empty outside of the window.
  cv::Mat picture(std::optional<cv::Rect> area = {}) const;
  cv::Size size() const;

  void set_look(bool dark, float scale);
  /// What `scale` is when 0 was asked for.
  float display_scale() const;
  void set_title(const std::string& title);
  /// From any thread: a wait() under way returns.
  static void wake();

 private:
  void make_window(const WindowOptions& options);
  void take(const InputEvent& event);
  void load_font(float scale);

  GLFWwindow* window_ = nullptr;
  bool scripted_ = false;
  float font_scale_ = 0.0F;
  double last_time_s_ = 0.0;
  std::deque<InputEvent> queue_;
  std::vector<Eigen::Vector2d> pointer_path_;
  std::vector<std::string> dropped_;
  bool close_asked_ = false;
};

}  // namespace fathom
