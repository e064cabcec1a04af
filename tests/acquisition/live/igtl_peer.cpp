// An OpenIGTLink server made of the library's own classes, as devices and PLUS use them; the other end of the tests.
//
// igtl_peer FRAMES RATE COUNT CUT_EVERY: sends COUNT frames of PeerFrames(FRAMES) at RATE frames/s, to whoever connects
// first and then again after each cut: after every CUT_EVERY frames (0: never) it closes the connection. Frames that
// come due while nobody is connected are not sent. Writes its port, and in the end the numbers of frames sent and of
// those that were not. Stamps are of this computer's steady clock: the moment before packing and sending, or, where the
// connection is cut, the moment at which the frame was due.

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <thread>

#include <igtlImageMessage.h>
#include <igtlServerSocket.h>
#include <igtlTransformMessage.h>

#include "acquisition/live/live_source.h"
#include "tests/acquisition/live/peer_frames.h"

namespace {

igtl::TimeStamp::Pointer stamp(double time_s) {
  const igtl::TimeStamp::Pointer time = igtl::TimeStamp::New();
  time->SetTime(time_s);
  return time;
}

bool send(igtl::ClientSocket& socket, igtl::MessageBase& message, double time_s) {
  auto time = stamp(time_s);
  message.SetTimeStamp(time);
  message.Pack();
  return socket.Send(message.GetPackPointer(), message.GetPackSize()) != 0;
}

bool send_pose(igtl::ClientSocket& socket, const fathom::PeerFrames::NamedMatrix& pose, double time_s) {
  const auto message = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix[row][column] = static_cast<float>(pose.matrix(row, column));
  }
  message->SetDeviceName(pose.name.c_str());
  message->SetMatrix(matrix);
  return send(socket, *message, time_s);
}

bool send_image(igtl::ClientSocket& socket, const cv::Mat& image, double time_s) {
  const auto message = igtl::ImageMessage::New();
  message->SetDeviceName("Image");
  message->SetDimensions(image.cols, image.rows, 1);
  message->SetSubVolume(image.cols, image.rows, 1, 0, 0, 0);
  message->SetSpacing(1.0f, 1.0f, 1.0f);
  message->SetScalarTypeToUint8();
  message->AllocateScalars();
  std::memcpy(message->GetScalarPointer(), image.data, image.total());
  return send(socket, *message, time_s);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const fathom::PeerFrames frames(argv[1]);
  const double rate_hz = std::atof(argv[2]);
  const int count = std::atoi(argv[3]);
  const int cut_every = std::atoi(argv[4]);
  const auto server = igtl::ServerSocket::New();
  if (server->CreateServer(0) != 0) return 1;
  std::cout << server->GetServerPort() << std::endl;

  igtl::ClientSocket::Pointer client = server->WaitForConnection(20000);
  const double begin_s = fathom::live_clock_s();
  int sent = 0;
  int unsent = 0;
  for (int frame = 0; frame < count; ++frame) {
    const double due_s = begin_s + frame / rate_hz;
    std::this_thread::sleep_for(std::chrono::duration<double>(due_s - fathom::live_clock_s()));
    if (client.IsNull()) client = server->WaitForConnection(1);
    if (client.IsNull()) {
      ++unsent;
      continue;
    }
    const double time_s = cut_every > 0 ? due_s : fathom::live_clock_s();
    for (const auto& pose : frames.poses(frame)) send_pose(*client, pose, time_s);
    send_image(*client, frames.image(frame), time_s) ? ++sent : ++unsent;
    if (cut_every > 0 && sent % cut_every == 0 && frame + 1 < count) {
      client->CloseSocket();
      client = nullptr;
    }
  }
  std::cout << sent << " " << unsent << std::endl;
  // The client is to end the connection, so that none of it is lost.
  char ignored;
  if (client.IsNotNull()) {
    client->SetReceiveTimeout(20000);
    client->Receive(&ignored, 1);
  }
  return 0;
}
