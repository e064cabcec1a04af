// Whether VTK, and so ITK and 3D Slicer, whose MetaImage reader it has, finds the same frames in two recordings: what
// was sent and what `fathom record` made of it. Fathom's own reader has no part in it.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <vtkImageData.h>
#include <vtkMetaImageReader.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>

namespace {

vtkSmartPointer<vtkImageData> read(const char* file) {
  const vtkNew<vtkMetaImageReader> reader;
  if (reader->CanReadFile(file) == 0) {
    std::fprintf(stderr, "%s: VTK does not read it as a MetaImage\n", file);
    std::exit(1);
  }
  reader->SetFileName(file);
  reader->Update();
  return reader->GetOutput();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: vtk_frames RECORDING RECORDING\n");
    return 2;
  }
  const std::array images = {read(argv[1]), read(argv[2])};
  std::array<std::array<int, 3>, 2> sizes{};
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i]->GetDimensions(sizes[i].data());
    std::printf("%s: %d x %d pixels, %d frames, %s, %d channels\n", argv[i + 1], sizes[i][0], sizes[i][1], sizes[i][2],
                images[i]->GetScalarTypeAsString(), images[i]->GetNumberOfScalarComponents());
  }
  const auto frame_bytes =
      static_cast<std::size_t>(sizes[0][0]) * static_cast<std::size_t>(sizes[0][1]) *
      static_cast<std::size_t>(images[0]->GetScalarSize() * images[0]->GetNumberOfScalarComponents());
  if (sizes[0] != sizes[1] || images[0]->GetScalarType() != images[1]->GetScalarType() ||
      images[0]->GetNumberOfScalarComponents() != images[1]->GetNumberOfScalarComponents() || frame_bytes == 0) {
    std::printf("different\n");
    return 1;
  }
  int equal = 0;
  for (int frame = 0; frame < sizes[0][2]; ++frame) {
    equal += std::memcmp(images[0]->GetScalarPointer(0, 0, frame), images[1]->GetScalarPointer(0, 0, frame),
                         frame_bytes) == 0;
  }
  std::printf("%d of %d frames are equal\n", equal, sizes[0][2]);
  return equal == sizes[0][2] ? 0 : 1;
}
