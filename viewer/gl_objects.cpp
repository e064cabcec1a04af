#include "viewer/gl_objects.h"

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.h"
#include "viewer/gl.h"

namespace fathom {

namespace {

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
uniform mat4 clip;
uniform mat4 view;
out vec3 normal_in_view;
out vec4 own_color;
void main() {
  gl_Position = clip * vec4(position, 1.0);
  normal_in_view = mat3(view) * normal;
  own_color = color;
}
)";

// A lamp at the eye, from either side.
constexpr const char* kFragmentShader = R"(#version 330 core
in vec3 normal_in_view;
in vec4 own_color;
uniform vec4 tint;
out vec4 color;
void main() {
  float light = 1.0;
  float length2 = dot(normal_in_view, normal_in_view);
  if (length2 > 0.01) light = 0.3 + 0.7 * abs(normal_in_view.z) * inversesqrt(length2);
  color = vec4(own_color.rgb * tint.rgb * light, own_color.a * tint.a);
}
)";

unsigned compile_shader(unsigned kind, const char* text) {
  const unsigned shader = gl::CreateShader(kind);
  gl::ShaderSource(shader, 1, &text, nullptr);
  gl::CompileShader(shader);
  int good = 0;
  gl::GetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == 0) throw Error("display: its OpenGL driver does not compile GLSL 3.30; install another driver");
  return shader;
}

}  // namespace

Texture::~Texture() {
  if (id_ != 0) gl::DeleteTextures(1, &id_);
}

void Texture::resize(cv::Size size) {
  if (id_ == 0) gl::GenTextures(1, &id_);
  gl::BindTexture(GL_TEXTURE_2D, id_);
  if (size == size_) return;
  gl::TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, size.width, size.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl::TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl::TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl::TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl::TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  size_ = size;
}

void Texture::upload(const cv::Mat& rgba) {
  CV_Assert(rgba.type() == CV_8UC4 && rgba.isContinuous());
  resize(rgba.size());
  gl::PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl::TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, rgba.cols, rgba.rows, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
}

Canvas::~Canvas() {
  if (framebuffer_ != 0) gl::DeleteFramebuffers(1, &framebuffer_);
  if (depth_ != 0) gl::DeleteRenderbuffers(1, &depth_);
}

void Canvas::begin(cv::Size size) {
  const bool resized = framebuffer_ == 0 || size != texture_.size();
  if (framebuffer_ == 0) {
    gl::GenFramebuffers(1, &framebuffer_);
    gl::GenRenderbuffers(1, &depth_);
  }
  gl::BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (resized) {
    texture_.resize(size);
    gl::BindRenderbuffer(GL_RENDERBUFFER, depth_);
    gl::RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, size.width, size.height);
    gl::FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    gl::FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_.id(), 0);
    if (gl::CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      gl::BindFramebuffer(GL_FRAMEBUFFER, 0);
      throw Error("display: its OpenGL driver draws into no picture; install another driver");
    }
  }
  gl::Viewport(0, 0, size.width, size.height);
}

void Canvas::finish() { gl::BindFramebuffer(GL_FRAMEBUFFER, 0); }

VertexList::~VertexList() {
  if (buffer_ != 0) gl::DeleteBuffers(1, &buffer_);
  if (array_ != 0) gl::DeleteVertexArrays(1, &array_);
}

void VertexList::upload(std::span<const SceneVertex> vertices) {
  if (array_ == 0) {
    gl::GenVertexArrays(1, &array_);
    gl::GenBuffers(1, &buffer_);
    gl::BindVertexArray(array_);
    gl::BindBuffer(GL_ARRAY_BUFFER, buffer_);
    const auto attribute = [](unsigned place, int size, unsigned type, bool unit, std::size_t offset) {
      gl::EnableVertexAttribArray(place);
      gl::VertexAttribPointer(place, size, type, unit ? GL_TRUE : GL_FALSE, sizeof(SceneVertex),
                              reinterpret_cast<const void*>(offset));
    };
    attribute(0, 3, GL_FLOAT, false, 0);
    attribute(1, 3, GL_FLOAT, false, sizeof(Eigen::Vector3f));
    attribute(2, 4, GL_UNSIGNED_BYTE, true, 2 * sizeof(Eigen::Vector3f));
  }
  count_ = vertices.size();
  gl::BindVertexArray(array_);
  gl::BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl::BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(), GL_STATIC_DRAW);
  gl::BindVertexArray(0);
}

void VertexList::draw(unsigned mode) const {
  if (count_ == 0) return;
  gl::BindVertexArray(array_);
  gl::DrawArrays(mode, 0, static_cast<GLsizei>(count_));
  gl::BindVertexArray(0);
}

void VertexList::draw_lines() const { draw(GL_LINES); }

void VertexList::draw_triangles() const { draw(GL_TRIANGLES); }

SceneProgram::~SceneProgram() {
  if (id_ != 0) gl::DeleteProgram(id_);
}

void SceneProgram::compile() {
  const unsigned vertex = compile_shader(GL_VERTEX_SHADER, kVertexShader);
  const unsigned fragment = compile_shader(GL_FRAGMENT_SHADER, kFragmentShader);
  id_ = gl::CreateProgram();
  gl::AttachShader(id_, vertex);
  gl::AttachShader(id_, fragment);
  gl::LinkProgram(id_);
  gl::DeleteShader(vertex);
  gl::DeleteShader(fragment);
  int good = 0;
  gl::GetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good == 0) throw Error("display: its OpenGL driver does not link programs; install another driver");
  clip_ = gl::GetUniformLocation(id_, "clip");
  view_ = gl::GetUniformLocation(id_, "view");
  tint_ = gl::GetUniformLocation(id_, "tint");
}

void SceneProgram::use(const Eigen::Matrix4f& clip_from_reference, const Eigen::Matrix4f& view_from_reference,
                       const Eigen::Vector4f& tint) {
  if (id_ == 0) compile();
  gl::UseProgram(id_);
  gl::UniformMatrix4fv(clip_, 1, GL_FALSE, clip_from_reference.data());
  gl::UniformMatrix4fv(view_, 1, GL_FALSE, view_from_reference.data());
  gl::Uniform4fv(tint_, 1, tint.data());
}

cv::Mat read_pixels(cv::Rect area, int window_height) {
  cv::Mat upside_down(area.height, area.width, CV_8UC3);
  gl::PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl::ReadPixels(area.x, window_height - area.y - area.height, area.width, area.height, GL_BGR, GL_UNSIGNED_BYTE,
                 upside_down.data);
  cv::Mat pixels;
  cv::flip(upside_down, pixels, 0);
  return pixels;
}

}  // namespace fathom
