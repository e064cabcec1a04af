#include "benchmarks/peers/vtk_threads.h"

#include <vtkSMPTools.h>

void set_vtk_threads(int count) { vtkSMPTools::Initialize(count); }
