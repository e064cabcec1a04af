#pragma once

#include "core/volume.h"

namespace fathom {

/// Grey-value morphology with a disc that lies in a slice, slice by slice; Treece 2000, appendix D.1. Slices do not
/// affect each other, and nothing is assumed of what lies outside of a slice.
///
/// `radius_mm` is measured with the geometry of the volume, so that the disc is round whatever the shape of a pixel; it
/// holds the pixels whose centres lie within the radius. One smaller than a pixel's sides changes nothing.
/// Throws Error when the radius is not positive and finite, or the volume is empty or of a type other than integers of
/// 8 or 16 bits, float and double of one channel.

/// Takes away what is bright and too small to hold the disc: specks, thin bridges. Never brighter than before.
Volume open_slices(const Volume& volume, double radius_mm);

/// Fills what is dark and too small to hold the disc: holes, gaps. Never darker than before.
Volume close_slices(const Volume& volume, double radius_mm);

}  // namespace fathom
