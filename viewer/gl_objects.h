#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "viewer/scene_vertex.h"

namespace fathom {

/// What OpenGL owns, by its number; all of it must go before the context does.

/// A picture on the graphics card, replaced as a whole.
class Texture {
 public:
  Texture() = default;
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  /// `rgba` is CV_8UC4. Memory is taken anew only where the size changes.
  void upload(const cv::Mat& rgba);
  void resize(cv::Size size);
  unsigned id() const { return id_; }
  cv::Size size() const { return size_; }

 private:
  unsigned id_ = 0;
  cv::Size size_;
};

/// A picture to draw into, with depth.
class Canvas {
 public:
  Canvas() = default;
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Whatever is drawn from here to finish() goes into the picture, of `size` pixels. Throws Error where the driver
  /// refuses.
  void begin(cv::Size size);
  void finish();
  unsigned texture() const { return texture_.id(); }

 private:
  Texture texture_;
  unsigned framebuffer_ = 0;
  unsigned depth_ = 0;
};

/// Vertices on the graphics card.
class VertexList {
 public:
  VertexList() = default;
  ~VertexList();
  VertexList(const VertexList&) = delete;
  VertexList& operator=(const VertexList&) = delete;

  void upload(std::span<const SceneVertex> vertices);
  void draw_lines() const;
  void draw_triangles() const;
  std::size_t size() const { return count_; }

 private:
  void draw(unsigned mode) const;

  unsigned array_ = 0;
  unsigned buffer_ = 0;
  std::size_t count_ = 0;
};

/// The one program that draws scenes: lit where there is a normal.
class SceneProgram {
 public:
  SceneProgram() = default;
  ~SceneProgram();
  SceneProgram(const SceneProgram&) = delete;
  SceneProgram& operator=(const SceneProgram&) = delete;

  /// Compiled at first use. `tint` (red, green, blue, opacity) multiplies every vertex's own colour. Throws Error where
  /// the driver refuses.
  void use(const Eigen::Matrix4f& clip_from_reference, const Eigen::Matrix4f& view_from_reference,
           const Eigen::Vector4f& tint);

 private:
  void compile();

  unsigned id_ = 0;
  int clip_ = -1;
  int view_ = -1;
  int tint_ = -1;
};

/// The pixels of the window's part `area` (from its top left corner), 8-bit BGR.
cv::Mat read_pixels(cv::Rect area, int window_height);

}  // namespace fathom
