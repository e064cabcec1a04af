#include "viewer/gl.h"

#include <string>

#include "core/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fathom::gl {

#define FATHOM_GL_DEFINE(type, name) type name = nullptr;
FATHOM_GL_FUNCTIONS(FATHOM_GL_DEFINE)
#undef FATHOM_GL_DEFINE

namespace {

template <typename Function>
void find(Function& function, const char* name) {
  function = reinterpret_cast<Function>(glfwGetProcAddress(name));
  if (function == nullptr) {
    throw Error(std::string("display: its OpenGL driver lacks ") + name + "; the viewer needs OpenGL 3.3");
  }
}

}  // namespace

void load() {
#define FATHOM_GL_FIND(type, name) find(name, "gl" #name);
  FATHOM_GL_FUNCTIONS(FATHOM_GL_FIND)
#undef FATHOM_GL_FIND
}

}  // namespace fathom::gl
