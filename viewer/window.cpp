#include "viewer/window.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "core/error.h"
#include "viewer/gl.h"
#include "viewer/gl_objects.h"
#include "viewer/look.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fathom {

namespace {

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "" : std::string(" (") + text + ")";
}

Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

// What the hand does; a script's events do not come this way.
void listen(GLFWwindow* window) {
  using Kind = InputEvent::Kind;
  glfwSetCursorPosCallback(
      window, [](GLFWwindow* w, double x, double y) { of(w).push({.kind = Kind::kMove, .x = x, .y = y}); });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
    of(w).push({.kind = Kind::kButton, .code = button, .down = action == GLFW_PRESS});
  });
  glfwSetScrollCallback(window,
                        [](GLFWwindow* w, double x, double y) { of(w).push({.kind = Kind::kWheel, .x = x, .y = y}); });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action != GLFW_REPEAT) of(w).push({.kind = Kind::kKey, .code = key, .down = action == GLFW_PRESS});
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned c) { of(w).push({.kind = Kind::kText, .text = c}); });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    of(w).push({.kind = Kind::kDrop, .paths = std::vector<std::string>(paths, paths + count)});
  });
}

constexpr std::array<std::pair<ImGuiKey_, int>, 22> kKeyMap{{{ImGuiKey_Tab, GLFW_KEY_TAB},
                                                             {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
                                                             {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
                                                             {ImGuiKey_UpArrow, GLFW_KEY_UP},
                                                             {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
                                                             {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
                                                             {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN},
                                                             {ImGuiKey_Home, GLFW_KEY_HOME},
                                                             {ImGuiKey_End, GLFW_KEY_END},
                                                             {ImGuiKey_Insert, GLFW_KEY_INSERT},
                                                             {ImGuiKey_Delete, GLFW_KEY_DELETE},
                                                             {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
                                                             {ImGuiKey_Space, GLFW_KEY_SPACE},
                                                             {ImGuiKey_Enter, GLFW_KEY_ENTER},
                                                             {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
                                                             {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
                                                             {ImGuiKey_A, GLFW_KEY_A},
                                                             {ImGuiKey_C, GLFW_KEY_C},
                                                             {ImGuiKey_V, GLFW_KEY_V},
                                                             {ImGuiKey_X, GLFW_KEY_X},
                                                             {ImGuiKey_Y, GLFW_KEY_Y},
                                                             {ImGuiKey_Z, GLFW_KEY_Z}}};

void set_up_imgui(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // what is kept is kept in the viewer's own settings
  for (const auto& [name, key] : kKeyMap) io.KeyMap[name] = key;
  io.ClipboardUserData = window;
  io.SetClipboardTextFn = [](void* w, const char* text) { glfwSetClipboardString(static_cast<GLFWwindow*>(w), text); };
  io.GetClipboardTextFn = [](void* w) { return glfwGetClipboardString(static_cast<GLFWwindow*>(w)); };
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

}  // namespace

Window::Window(const WindowOptions& options) : scripted_(options.scripted) {
  if (glfwInit() == GLFW_FALSE) {
    throw Error("display: there is none to open a window on" + last_glfw_error() +
                "; start the viewer on a desktop, or under xvfb-run");
  }
  try {
    make_window(options);
  } catch (...) {
    glfwTerminate();
    throw;
  }
  last_time_s_ = glfwGetTime();
}

void Window::make_window(const WindowOptions& options) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  window_ = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    throw Error("display: has no OpenGL 3.3" + last_glfw_error() +
                "; install a driver for the graphics card, or Mesa's software driver (Debian libgl1-mesa-dri)");
  }
  glfwMakeContextCurrent(window_);
  gl::load();
  glfwSwapInterval(options.scripted ? 0 : 1);
  glfwSetWindowUserPointer(window_, this);
  glfwSetWindowCloseCallback(window_, [](GLFWwindow* w) { of(w).push({.kind = InputEvent::Kind::kClose}); });
  if (!options.scripted) listen(window_);
  set_up_imgui(window_);
  set_look(options.dark, options.scale > 0.0F ? options.scale : display_scale());
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

float Window::display_scale() const {
  float x = 1.0F;
  float y = 1.0F;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::clamp(x, 1.0F, 4.0F);
}

void Window::set_look(bool dark, float scale) {
  if (scale != font_scale_) {
    load_font(scale);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    font_scale_ = scale;
  }
  apply_look(dark, scale);
}

void Window::load_font(float scale) { load_look_font(scale); }

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::wait(double seconds) {
  if (!queue_.empty() || seconds <= 0.0) {
    glfwPollEvents();
  } else {
    glfwWaitEventsTimeout(seconds);
  }
}

void Window::wake() { glfwPostEmptyEvent(); }

void Window::take(const InputEvent& event) {
  ImGuiIO& io = ImGui::GetIO();
  switch (event.kind) {
    case InputEvent::Kind::kMove:
      io.MousePos = ImVec2(static_cast<float>(event.x), static_cast<float>(event.y));
      pointer_path_.emplace_back(event.x, event.y);
      break;
    case InputEvent::Kind::kButton:
      if (event.code >= 0 && event.code < 5) io.MouseDown[event.code] = event.down;
      break;
    case InputEvent::Kind::kWheel:
      io.MouseWheelH += static_cast<float>(event.x);
      io.MouseWheel += static_cast<float>(event.y);
      break;
    case InputEvent::Kind::kKey:
      if (event.code >= 0 && event.code < 512) io.KeysDown[event.code] = event.down;
      break;
    case InputEvent::Kind::kText:
      io.AddInputCharacter(event.text);
      break;
    case InputEvent::Kind::kDrop:
      dropped_.insert(dropped_.end(), event.paths.begin(), event.paths.end());
      break;
    case InputEvent::Kind::kClose:
      close_asked_ = true;
      break;
  }
}

void Window::begin_frame() {
  pointer_path_.clear();
  while (!queue_.empty()) {
    const InputEvent event = std::move(queue_.front());
    queue_.pop_front();
    take(event);
    // A press and its release within one frame would be lost on widgets.
    const bool edge = event.kind == InputEvent::Kind::kButton || event.kind == InputEvent::Kind::kKey;
    if (edge) break;
  }
  ImGuiIO& io = ImGui::GetIO();
  const auto either = [&](int left, int right) { return io.KeysDown[left] || io.KeysDown[right]; };
  io.KeyCtrl = either(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
  io.KeyShift = either(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
  io.KeyAlt = either(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
  io.KeySuper = either(GLFW_KEY_LEFT_SUPER, GLFW_KEY_RIGHT_SUPER);
  int width = 0;
  int height = 0;
  glfwGetWindowSize(window_, &width, &height);
  const cv::Size pixels = size();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  if (width > 0 && height > 0) {
    io.DisplayFramebufferScale = ImVec2(static_cast<float>(pixels.width) / static_cast<float>(width),
                                        static_cast<float>(pixels.height) / static_cast<float>(height));
  }
  const double now_s = glfwGetTime();
  io.DeltaTime = static_cast<float>(std::clamp(now_s - last_time_s_, 1e-4, 0.1));
  last_time_s_ = now_s;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
}

void Window::end_frame() {
  ImGui::Render();
  const cv::Size pixels = size();
  gl::Viewport(0, 0, pixels.width, pixels.height);
  gl::ClearColor(0.0F, 0.0F, 0.0F, 1.0F);
  gl::Clear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
}

std::vector<std::string> Window::take_dropped() { return std::exchange(dropped_, {}); }

cv::Size Window::size() const {
  cv::Size pixels;
  glfwGetFramebufferSize(window_, &pixels.width, &pixels.height);
  return pixels;
}

cv::Mat Window::picture(std::optional<cv::Rect> area) const {
  const cv::Rect whole({0, 0}, size());
  const cv::Rect part = area ? *area & whole : whole;
  if (part.empty()) return {};
  // What was shown may be gone from the back buffer, so it is drawn again.
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return read_pixels(part, whole.height);
}

}  // namespace fathom
