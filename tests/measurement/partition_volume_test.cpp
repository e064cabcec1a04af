#include "measurement/partition_volume.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"

namespace fathom {
namespace {

// Tilted ellipses on planes that fan out about an axis below them: non-parallel, so that (4.8) does not vanish.
std::vector<SectionOutline> fan_of_ellipses() {
  std::vector<SectionOutline> sections;
  for (int i = 0; i < 9; ++i) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.08 * (i - 4), Eigen::Vector3d::UnitX()).toRotationMatrix();
    SectionOutline section;
    Polygon3 outline;
    for (int k = 0; k < 60; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / 60;
      outline.push_back(
          turn * Eigen::Vector3d((12.0 + 0.5 * i) * std::cos(angle) + 0.4 * i, 60.0 + 8.0 * std::sin(angle), 0.0));
    }
    section.whole.frame = i;
    section.whole.normal = turn.col(2);
    section.whole.vector_area_mm2 = vector_area(outline);
    // A regular ellipse's polygon has its middle as centroid.
    section.whole.centroid_mm = turn * Eigen::Vector3d(0.4 * i, 60.0, 0.0);
    section.outlines = {outline};
    sections.push_back(section);
  }
  return sections;
}

SweepShape one_centre(const Eigen::Vector3d& centre_mm) { return {{centre_mm}, {centre_mm}, {centre_mm}}; }

TEST(PartitionVolume, OnePlaneThroughAllSectionsChangesLinearPlanimetryByTheSecondTermOf48) {
  const auto sections = fan_of_ellipses();
  std::vector<CrossSection> wholes;
  for (const SectionOutline& section : sections) wholes.push_back(section.whole);
  const double whole_ml = linear_planimetry_ml(wholes);
  double largest = 0.0;
  for (int k = 0; k < 10; ++k) {
    const double angle = -0.5 + 0.1 * k;
    const Eigen::Vector3d normal(std::cos(angle), 0.3 * std::sin(angle), std::sin(angle));
    const DividingPlane plane(normal.normalized(), Eigen::Vector3d(1.6, 60, 0));
    const SpacePartition partition(
        {one_centre(Eigen::Vector3d(0, 60, 0) - 50 * normal), one_centre(Eigen::Vector3d(0, 60, 0) + 50 * normal)},
        {plane});
    ASSERT_EQ(partition.region_count(), 2u);
    const auto a = clip_sections(sections, partition, 0);
    const auto b = clip_sections(sections, partition, 1);
    ASSERT_EQ(a.size(), sections.size()) << "the plane must cut every section";
    ASSERT_EQ(b.size(), sections.size());
    const double change_ml = linear_planimetry_ml(a) + linear_planimetry_ml(b) - whole_ml;
    double term = 0.0;
    for (std::size_t i = 1; i < a.size(); ++i) {
      const auto share = [&](std::size_t n) { return a[n].vector_area_mm2.norm() / wholes[n].vector_area_mm2.norm(); };
      const auto alpha = [&](std::size_t n) { return Eigen::Vector3d(wholes[n].centroid_mm - a[n].centroid_mm); };
      term += (share(i) - share(i - 1)) * (wholes[i].vector_area_mm2.dot(alpha(i - 1)) / (1.0 - share(i - 1)) +
                                           wholes[i - 1].vector_area_mm2.dot(alpha(i)) / (1.0 - share(i)));
    }
    EXPECT_NEAR(change_ml, 0.5 * term / 1000.0, 1e-12 * whole_ml) << "angle " << angle;
    largest = std::max(largest, std::abs(change_ml) / whole_ml);
  }
  EXPECT_GT(largest, 1e-4) << "or nothing was tested";
}

TEST(PartitionVolume, AreasAndMomentsOfThePartsAddUpToTheWhole) {
  const auto sections = fan_of_ellipses();
  const SpacePartition partition({one_centre({-50, 60, 0}), one_centre({50, 60, 0})},
                                 {DividingPlane(Eigen::Vector3d(3, 1, 1).normalized(), Eigen::Vector3d(1, 60, 0))});
  const auto a = clip_sections(sections, partition, 0);
  const auto b = clip_sections(sections, partition, 1);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const CrossSection& whole = sections[i].whole;
    EXPECT_LT((a[i].vector_area_mm2 + b[i].vector_area_mm2 - whole.vector_area_mm2).norm(), 1e-9);
    const Eigen::Vector3d moment =
        a[i].vector_area_mm2.norm() * a[i].centroid_mm + b[i].vector_area_mm2.norm() * b[i].centroid_mm;
    EXPECT_LT((moment / whole.vector_area_mm2.norm() - whole.centroid_mm).norm(), 1e-9);
  }
}

TEST(PartitionVolume, WhatLeavesARegionAndComesBackIsNotBridged) {
  // Rectangles of 3 mm on parallel planes 2 mm apart, which reach across the dividing plane but for two in the middle
  // and, on the other side, one: linear planimetry is a weighted sum of areas, so that its parts add up exactly.
  std::vector<SectionOutline> sections;
  for (const double shift_mm : {0.0, 0.5, -8.0, -9.0, 0.3, 0.6, 9.0, 0.8, 0.1}) {
    const double z_mm = 2.0 * static_cast<double>(sections.size());
    const Polygon3 outline = {
        {shift_mm - 4, 0, z_mm}, {shift_mm + 4, 0, z_mm}, {shift_mm + 4, 3, z_mm}, {shift_mm - 4, 3, z_mm}};
    SectionOutline section;
    section.whole.frame = static_cast<int>(sections.size());
    section.whole.vector_area_mm2 = vector_area(outline);
    section.whole.centroid_mm = {shift_mm, 1.5, z_mm};
    section.outlines = {outline};
    sections.push_back(section);
  }
  std::vector<CrossSection> wholes;
  for (const SectionOutline& section : sections) wholes.push_back(section.whole);
  const SpacePartition partition({one_centre({-50, 0, 0}), one_centre({50, 0, 0})},
                                 {DividingPlane(Eigen::Vector3d::UnitX(), 0.0)});
  double sum_ml = 0.0;
  for (const std::size_t region : {0u, 1u}) {
    const auto all = with_absences(sections, clip_each(sections, partition, region), partition, region);
    EXPECT_EQ(all.size(), sections.size());
    sum_ml += linear_planimetry_ml(all);
  }
  EXPECT_NEAR(sum_ml, linear_planimetry_ml(wholes), 1e-12);
}

TEST(StaysOpen, OnlyWithBothEndsInAHatchedRegion) {
  const SpacePartition partition({one_centre({-50, 0, 0}), one_centre({50, 0, 0})},
                                 {DividingPlane(Eigen::Vector3d::UnitX(), 0.0)});
  const Eigen::Affine3d map = Eigen::Affine3d::Identity();
  EXPECT_TRUE(stays_open({{5, 0}, {-5, 3}, {6, 6}}, map, 0, partition));
  EXPECT_FALSE(stays_open({{5, 0}, {-5, 3}, {-6, 6}}, map, 0, partition));
  EXPECT_FALSE(stays_open({{5, 0}, {-5, 3}, {6, 6}}, map, 1, partition));
}

}  // namespace
}  // namespace fathom
