#pragma once

/// How many threads VTK's filters use from now on.
void set_vtk_threads(int count);
