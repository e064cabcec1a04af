#include "acquisition/live/igtl_reader.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>
#include <igtlImageMessage.h>
#include <igtlPositionMessage.h>
#include <igtlQuaternionTrackingDataMessage.h>
#include <igtlStatusMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtl_util.h>

#include "core/random.h"
#include "tests/acquisition/live/igtl_bytes.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

Bytes packed(igtl::MessageBase& message) {
  message.Pack();
  const auto* begin = static_cast<const std::byte*>(message.GetPackPointer());
  return {begin, begin + message.GetPackSize()};
}

igtl::Matrix4x4& fill(igtl::Matrix4x4& matrix, double angle) {
  const float c = static_cast<float>(std::cos(angle));
  const float s = static_cast<float>(std::sin(angle));
  const float rows[4][4] = {{c, -s, 0, 1.5f}, {s, c, 0, -2.25f}, {0, 0, 1, 1e3f / 7}, {0, 0, 0, 1}};
  std::memcpy(&matrix, rows, sizeof rows);
  return matrix;
}

void expect_filled(const Eigen::Matrix4d& matrix, double angle, double tolerance = 0.0) {
  igtl::Matrix4x4 expected;
  fill(expected, angle);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(matrix(row, column), static_cast<double>(expected[row][column]), tolerance) << row << " " << column;
    }
  }
}

TEST(IgtlChecksum, IsTheLibrarysForAllLengths) {
  Random random(3);
  for (std::size_t size = 0; size < 70; ++size) {
    Bytes bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.uniform(0.0, 256.0));
    const auto theirs = crc64(reinterpret_cast<unsigned char*>(bytes.data()), size, 0x1234567890abcdef);
    EXPECT_EQ(igtl_checksum(bytes, 0x1234567890abcdef), theirs) << size;
  }
}

TEST(IgtlReader, ReadsImagesOfEveryTypeThatCanBeRecorded) {
  const std::pair<int, int> types[] = {
      {igtl::ImageMessage::TYPE_UINT8, CV_8UC1},    {igtl::ImageMessage::TYPE_INT8, CV_8SC1},
      {igtl::ImageMessage::TYPE_UINT16, CV_16UC1},  {igtl::ImageMessage::TYPE_INT16, CV_16SC1},
      {igtl::ImageMessage::TYPE_FLOAT32, CV_32FC1}, {igtl::ImageMessage::TYPE_FLOAT64, CV_64FC1},
      {igtl::ImageMessage::TYPE_UINT8, CV_8UC3}};
  for (const auto& [scalar, type] : types) {
    SampleOptions options;
    options.pixel_type = type;
    const cv::Mat image = sample_recording(options).image(1).clone();
    const auto message = igtl::ImageMessage::New();
    message->SetDeviceName("Image");
    message->SetDimensions(image.cols, image.rows, 1);
    message->SetSubVolume(image.cols, image.rows, 1, 0, 0, 0);
    message->SetScalarType(scalar);
    message->SetNumComponents(image.channels());
    message->SetEndian(igtl::ImageMessage::ENDIAN_LITTLE);
    message->AllocateScalars();
    std::memcpy(message->GetScalarPointer(), image.data, image.total() * image.elemSize());
    const IgtlMessage read = read_all(packed(*message)).at(0);
    EXPECT_EQ(read.fault, "");
    EXPECT_EQ(read.header.device, "Image");
    EXPECT_TRUE(same_pixels(read.image, image)) << scalar;
    EXPECT_TRUE(read.fields.empty());
    EXPECT_EQ(read_all(igtl_image_message("Image", {}, image)).at(0).image.type(), type);
    EXPECT_TRUE(same_pixels(read_all(igtl_image_message("Image", {}, image)).at(0).image, image));
  }
}

TEST(IgtlReader, SwapsBytesAndKeepsTheImagesMatrix) {
  const auto message = igtl::ImageMessage::New();
  message->SetDimensions(2, 1, 1);
  message->SetSubVolume(2, 1, 1, 0, 0, 0);
  message->SetScalarTypeToUint16();
  message->SetEndian(igtl::ImageMessage::ENDIAN_BIG);
  message->SetSpacing(0.5f, 0.25f, 1.0f);
  message->SetOrigin(1.0f, 2.0f, 3.0f);
  message->AllocateScalars();
  std::memcpy(message->GetScalarPointer(), "\x01\x02\xff\x00", 4);
  const IgtlMessage read = read_all(packed(*message)).at(0);
  EXPECT_EQ(read.image.at<std::uint16_t>(0, 0), 0x0102);
  EXPECT_EQ(read.image.at<std::uint16_t>(0, 1), 0xff00);
  ASSERT_EQ(read.fields.size(), 1u);
  EXPECT_EQ(read.fields[0].first, "ImageMatrix");
  EXPECT_EQ(read.fields[0].second, "0.5 0 0 1 0 0.25 0 2 0 0 1 3 0 0 0 1");
}

TEST(IgtlReader, ReadsEveryTypeOfMessageThatStatesPoses) {
  igtl::Matrix4x4 matrix;
  const auto tdata = igtl::TrackingDataMessage::New();
  for (const auto& [name, angle] : {std::pair{"ProbeToReference", 0.1}, std::pair{"Stylus", 0.2}}) {
    auto element = igtl::TrackingDataElement::New();
    element->SetName(name);
    element->SetType(igtl::TrackingDataElement::TYPE_6D);
    element->SetMatrix(fill(matrix, angle));
    tdata->AddTrackingDataElement(element);
  }
  const auto from_tdata = read_all(packed(*tdata)).at(0).poses;
  ASSERT_EQ(from_tdata.size(), 2u);
  EXPECT_EQ(from_tdata[0].transform, "ProbeToReference");
  EXPECT_EQ(from_tdata[1].transform, "StylusToTracker");
  expect_filled(from_tdata[0].pose.matrix, 0.1);
  expect_filled(from_tdata[1].pose.matrix, 0.2);

  const auto qtdata = igtl::QuaternionTrackingDataMessage::New();
  auto element = igtl::QuaternionTrackingDataElement::New();
  element->SetName("ProbeToTracker");
  element->SetType(igtl::QuaternionTrackingDataElement::TYPE_6D);
  element->SetPosition(1.5f, -2.25f, 1e3f / 7);
  element->SetQuaternion(0.0f, 0.0f, static_cast<float>(std::sin(0.15)), static_cast<float>(std::cos(0.15)));
  qtdata->AddQuaternionTrackingDataElement(element);
  const auto from_qtdata = read_all(packed(*qtdata)).at(0).poses;
  ASSERT_EQ(from_qtdata.size(), 1u);
  expect_filled(from_qtdata[0].pose.matrix, 0.3, 1e-6);

  const auto position = igtl::PositionMessage::New();
  position->SetDeviceName("Probe");
  position->SetPosition(1.5f, -2.25f, 1e3f / 7);
  position->SetQuaternion(0.0f, 0.0f, static_cast<float>(std::sin(0.15)), static_cast<float>(std::cos(0.15)));
  const auto from_position = read_all(packed(*position)).at(0).poses;
  ASSERT_EQ(from_position.size(), 1u);
  EXPECT_EQ(from_position[0].transform, "ProbeToTracker");
  expect_filled(from_position[0].pose.matrix, 0.3, 1e-6);
}

TEST(IgtlReader, ReadsHeadersOfVersion2WithTheirMetadata) {
  const Bytes message =
      with_metadata(igtl_transform_message("LeftVentricleProbeTo", 12.5, Eigen::Matrix4d::Identity()),
                    {{"IGTL_DEVICE_NAME", "LeftVentricleProbeToReference"}, {"TransformStatus", "OUT_OF_VIEW"}});
  const IgtlMessage read = read_all(message).at(0);
  EXPECT_EQ(read.fault, "");
  EXPECT_EQ(read.header.time_s, 12.5);
  ASSERT_EQ(read.poses.size(), 1u);
  EXPECT_EQ(read.poses[0].transform, "LeftVentricleProbeToReference");
  EXPECT_EQ(read.poses[0].pose.status, "OUT_OF_VIEW");
  const cv::Mat image(3, 5, CV_8UC1, cv::Scalar(77));
  EXPECT_TRUE(
      same_pixels(read_all(with_metadata(igtl_image_message("I", {}, image), {{"a", "b"}})).at(0).image, image));
}

TEST(IgtlReader, MarksPosesThatAreNone) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(0, 3) = std::nan("");
  const auto read = [&](const std::string& name) { return read_all(igtl_transform_message(name, {}, matrix)).at(0); };
  EXPECT_EQ(read("ProbeToTracker").poses.at(0).pose.status, "NOT_FINITE");
  EXPECT_TRUE(read("ProbeToTracker").poses.at(0).pose.matrix.allFinite());
  matrix = Eigen::Vector4d(0.2, 0.2, 0.2, 1.0).asDiagonal();
  EXPECT_EQ(read("ProbeToTracker").poses.at(0).pose.status, "NOT_RIGID");
  EXPECT_TRUE(read("ImageToReference").poses.empty());
  EXPECT_NE(read("").fault, "");
}

TEST(IgtlReader, SkipsOtherTypesAndTellsOfStatuses) {
  const auto status = igtl::StatusMessage::New();
  status->SetCode(igtl::StatusMessage::STATUS_HARDWARE_FAILURE);
  status->SetErrorName("broken");
  status->SetStatusString("the probe fell down");
  auto bytes = packed(*status);
  EXPECT_EQ(read_all(bytes).at(0).complaint, "status 18, broken, the probe fell down");
  status->SetCode(igtl::StatusMessage::STATUS_OK);
  EXPECT_EQ(read_all(packed(*status)).at(0).complaint, "");
  const auto other = igtl::GetImageMessage::New();
  for (const std::byte byte : packed(*other)) bytes.push_back(byte);
  for (const std::byte byte : igtl_status_message("x", 5, "no", "access")) bytes.push_back(byte);
  const auto all = read_all(bytes);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].fault, "");
  EXPECT_EQ(all[2].complaint, "status 5, no, access");
}

TEST(IgtlReader, ADamagedMessageIsAFaultAndTheNextIsRead) {
  const cv::Mat image(30, 50, CV_8UC1, cv::Scalar(7));
  Bytes bytes = igtl_image_message("Image", 1.0, image);
  const std::size_t size = bytes.size();
  for (int i = 0; i < 2; ++i) {
    const Bytes next = igtl_image_message("Image", 1.0, image);
    bytes.insert(bytes.end(), next.begin(), next.end());
  }
  for (const std::size_t at : {kIgtlHeader_bytes, kIgtlHeader_bytes + 9, size - 1}) {
    Bytes damaged = bytes;
    damaged[size + at] ^= std::byte{0x10};
    const auto all = read_all(damaged);
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0].fault, "");
    EXPECT_NE(all[1].fault.find("checksum"), std::string::npos);
    EXPECT_TRUE(all[1].image.empty());
    EXPECT_EQ(all[2].fault, "");
  }
}

TEST(IgtlReader, RefusesWhatWouldTakeMemoryOrFitsNotTogether) {
  const cv::Mat image(3, 5, CV_8UC1, cv::Scalar(7));
  const auto fault = [&](std::size_t at, std::vector<int> values) {
    Bytes bytes = igtl_image_message("Image", {}, image);
    for (const int value : values) bytes[kIgtlHeader_bytes + at++] = static_cast<std::byte>(value);
    return read_all(with_checksum(bytes)).at(0).fault;
  };
  EXPECT_EQ(fault(0, {}), "");
  EXPECT_NE(fault(6, {255, 255, 255, 255}).find("part"), std::string::npos);
  EXPECT_NE(fault(3, {6}).find("type"), std::string::npos);
  EXPECT_NE(fault(3, {11}).find("no image of 5 x 3"), std::string::npos);
  EXPECT_NE(fault(2, {200}).find("type"), std::string::npos);
  EXPECT_NE(fault(4, {9}).find("order of its bytes"), std::string::npos);
  EXPECT_NE(read_all(with_checksum(igtl_message("TDATA", Bytes(71)))).at(0).fault, "");
  EXPECT_NE(read_all(with_checksum(igtl_message("STATUS", Bytes(3)))).at(0).fault, "");
  EXPECT_NE(read_all(with_checksum(igtl_message("TDATA", Bytes(70 * 20000)))).at(0).fault.find("large"),
            std::string::npos);
  // Nothing is known of what follows.
  EXPECT_THROW(read_all(igtl_message("no type", Bytes(3))), StreamError);
  Bytes endless = igtl_message("IMAGE", Bytes(3));
  endless[42] = std::byte{0x7f};
  EXPECT_THROW(read_all(endless), StreamError);
}

}  // namespace
}  // namespace fathom
