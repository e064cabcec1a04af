#pragma once

#include <GL/glcorearb.h>

namespace fathom::gl {

// The functions of OpenGL 3.3 core that the viewer calls: type and name, without the prefix "gl".
#define FATHOM_GL_FUNCTIONS(F)                                 \
  F(PFNGLATTACHSHADERPROC, AttachShader)                       \
  F(PFNGLBINDBUFFERPROC, BindBuffer)                           \
  F(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                 \
  F(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)               \
  F(PFNGLBINDTEXTUREPROC, BindTexture)                         \
  F(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                 \
  F(PFNGLBLENDFUNCSEPARATEPROC, BlendFuncSeparate)             \
  F(PFNGLBUFFERDATAPROC, BufferData)                           \
  F(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)   \
  F(PFNGLCLEARPROC, Clear)                                     \
  F(PFNGLCLEARCOLORPROC, ClearColor)                           \
  F(PFNGLCOMPILESHADERPROC, CompileShader)                     \
  F(PFNGLCREATEPROGRAMPROC, CreateProgram)                     \
  F(PFNGLCREATESHADERPROC, CreateShader)                       \
  F(PFNGLCULLFACEPROC, CullFace)                               \
  F(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                     \
  F(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)           \
  F(PFNGLDELETEPROGRAMPROC, DeleteProgram)                     \
  F(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)         \
  F(PFNGLDELETESHADERPROC, DeleteShader)                       \
  F(PFNGLDELETETEXTURESPROC, DeleteTextures)                   \
  F(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)           \
  F(PFNGLDEPTHMASKPROC, DepthMask)                             \
  F(PFNGLDISABLEPROC, Disable)                                 \
  F(PFNGLDRAWARRAYSPROC, DrawArrays)                           \
  F(PFNGLENABLEPROC, Enable)                                   \
  F(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
  F(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer) \
  F(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)       \
  F(PFNGLGENBUFFERSPROC, GenBuffers)                           \
  F(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                 \
  F(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)               \
  F(PFNGLGENTEXTURESPROC, GenTextures)                         \
  F(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                 \
  F(PFNGLGETPROGRAMIVPROC, GetProgramiv)                       \
  F(PFNGLGETSHADERIVPROC, GetShaderiv)                         \
  F(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)           \
  F(PFNGLLINKPROGRAMPROC, LinkProgram)                         \
  F(PFNGLPIXELSTOREIPROC, PixelStorei)                         \
  F(PFNGLREADPIXELSPROC, ReadPixels)                           \
  F(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)         \
  F(PFNGLSHADERSOURCEPROC, ShaderSource)                       \
  F(PFNGLTEXIMAGE2DPROC, TexImage2D)                           \
  F(PFNGLTEXPARAMETERIPROC, TexParameteri)                     \
  F(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)                     \
  F(PFNGLUNIFORM4FVPROC, Uniform4fv)                           \
  F(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)               \
  F(PFNGLUSEPROGRAMPROC, UseProgram)                           \
  F(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)         \
  F(PFNGLVIEWPORTPROC, Viewport)

#define FATHOM_GL_DECLARE(type, name) extern type name;
FATHOM_GL_FUNCTIONS(FATHOM_GL_DECLARE)
#undef FATHOM_GL_DECLARE

/// Finds every function; a context must be current. Throws Error where one is missing.
void load();

}  // namespace fathom::gl
