// Fathom's and VTK's surfaces of the same volumes, with normals, in one run: the least time of some rounds that take
// turns, processor and wall clock; and a mesh of good triangles, by VTK's pipeline and in one pass of RMT.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataNormals.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include "benchmarks/peers/vtk_threads.h"
#include "benchmarks/surface_fields.h"
#include "surface/isosurface.h"
#include "surface/mesh_measure.h"
#include "surface/mesh_quality.h"

namespace {

using namespace fathom;

double seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Contender {
  std::string name;
  std::function<long()> run;  // returns the number of triangles
  double wall_s = 1e9;
  double processor_s = 1e9;
  long triangles = 0;
};

void race(std::vector<Contender>& contenders, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Contender& contender : contenders) {
      const double wall = seconds(CLOCK_MONOTONIC);
      const double processor = seconds(CLOCK_PROCESS_CPUTIME_ID);
      contender.triangles = contender.run();
      contender.processor_s = std::min(contender.processor_s, seconds(CLOCK_PROCESS_CPUTIME_ID) - processor);
      contender.wall_s = std::min(contender.wall_s, seconds(CLOCK_MONOTONIC) - wall);
    }
  }
}

vtkNew<vtkImageData> image_of(const Volume& volume) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(volume.voxels.size[2], volume.voxels.size[1], volume.voxels.size[0]);
  image->AllocateScalars(VTK_FLOAT, 1);
  std::copy_n(volume.voxels.ptr<float>(), volume.voxels.total(), static_cast<float*>(image->GetScalarPointer()));
  return image;
}

template <typename Filter>
long contour(vtkImageData* image) {
  vtkNew<Filter> filter;
  filter->SetInputData(image);
  filter->SetValue(0, 0.0);
  filter->ComputeNormalsOn();
  filter->ComputeGradientsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  return filter->GetOutput()->GetNumberOfCells();
}

long rmt(const Volume& volume, Mesher mesher, VertexPlacement placement) {
  IsosurfaceOptions options;
  options.mesher.mesher = mesher;
  options.mesher.placement = placement;
  return static_cast<long>(isosurface(volume, options).triangles.size());
}

Mesh mesh_of(vtkPolyData* data) {
  Mesh mesh;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) mesh.vertices.emplace_back(data->GetPoint(i));
  vtkIdType count = 0;
  const vtkIdType* corners = nullptr;
  data->GetPolys()->InitTraversal();
  while (data->GetPolys()->GetNextCell(count, corners)) {
    mesh.triangles.push_back({static_cast<std::int32_t>(corners[0]), static_cast<std::int32_t>(corners[1]),
                              static_cast<std::int32_t>(corners[2])});
  }
  return mesh;
}

void print_quality(const char* name, const Mesh& mesh, double seconds_taken, double truth) {
  const MeshQuality quality = mesh_quality(mesh);
  std::printf("  %-34s %8.1f ms %8zu triangles, radius ratio p95 %.3f, above 2 %.3f %%, volume %+.3f %%\n", name,
              1e3 * seconds_taken, mesh.triangles.size(), quality.radius_ratio_p95, 100.0 * quality.above_2,
              100.0 * (std::abs(volume_mm3(mesh)) / truth - 1.0));
}

void compare_quality(int size) {
  const Volume volume = benchmarks::ball_volume(size, false);
  const vtkNew<vtkImageData> image = image_of(volume);
  const double radius = 0.4 * size;
  const double truth = 4.0 / 3.0 * 3.14159265358979323846 * radius * radius * radius;
  std::printf("a mesh of good triangles, ball of %d^3\n", size);
  double pipeline_s = 1e9;
  double rmt_s = 1e9;
  Mesh smoothed;
  Mesh regularised;
  for (int round = 0; round < 3; ++round) {
    double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    vtkNew<vtkMarchingCubes> cubes;
    cubes->SetInputData(image);
    cubes->SetValue(0, 0.0);
    cubes->ComputeNormalsOff();
    vtkNew<vtkDecimatePro> decimate;
    decimate->SetInputConnection(cubes->GetOutputPort());
    decimate->SetTargetReduction(0.4);
    decimate->PreserveTopologyOn();
    vtkNew<vtkWindowedSincPolyDataFilter> smooth;
    smooth->SetInputConnection(decimate->GetOutputPort());
    smooth->SetNumberOfIterations(20);
    smooth->SetPassBand(0.1);
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputConnection(smooth->GetOutputPort());
    normals->SplittingOff();
    normals->Update();
    pipeline_s = std::min(pipeline_s, seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    smoothed = mesh_of(normals->GetOutput());
    start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    regularised = isosurface(volume, {});
    rmt_s = std::min(rmt_s, seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
  }
  print_quality("cubes, decimated to 60 %, smoothed", smoothed, pipeline_s, truth);
  print_quality("RMT in one pass", regularised, rmt_s, truth);
  std::printf("  RMT is %.1f times faster\n", pipeline_s / rmt_s);
}

}  // namespace

int main(int argc, char** argv) {
  const int most_rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 40;
  for (const int size : {128, 256}) {
    const int rounds = std::max(1, most_rounds * 128 / size);
    for (const bool bumpy : {false, true}) {
      const Volume volume = benchmarks::ball_volume(size, bumpy);
      const vtkNew<vtkImageData> image = image_of(volume);
      for (const int threads : {1, 2}) {
        cv::setNumThreads(threads);
        set_vtk_threads(threads);
        std::vector<Contender> contenders = {
            {"vtkFlyingEdges3D", [&] { return contour<vtkFlyingEdges3D>(image); }},
            {"RMT, average", [&] { return rmt(volume, Mesher::kRegularised, VertexPlacement::kAverage); }},
            {"RMT, curvature", [&] { return rmt(volume, Mesher::kRegularised, VertexPlacement::kCurvature); }},
            {"vtkMarchingCubes", [&] { return contour<vtkMarchingCubes>(image); }},
            {"MC", [&] { return rmt(volume, Mesher::kCubes, VertexPlacement::kAverage); }},
            {"MT", [&] { return rmt(volume, Mesher::kTetrahedra, VertexPlacement::kAverage); }}};
        race(contenders, rounds);
        std::printf("%s of %d^3, %d thread%s\n", bumpy ? "bumpy ball" : "ball", size, threads, threads > 1 ? "s" : "");
        for (const Contender& contender : contenders) {
          std::printf("  %-18s wall %7.1f ms  processor %7.1f ms  %.2f of vtkFlyingEdges3D  %8ld triangles\n",
                      contender.name.c_str(), 1e3 * contender.wall_s, 1e3 * contender.processor_s,
                      contender.wall_s / contenders.front().wall_s, contender.triangles);
        }
      }
    }
  }
  cv::setNumThreads(1);
  compare_quality(256);
  return 0;
}
