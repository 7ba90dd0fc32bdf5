#pragma once
#include <memory>
#include <string>

#include "pbrt/cmd/pbrt/live_board.h"

namespace pbrt {

/// A page for browsers on this machine (127.0.0.1 only): the picture as it grows, an estimate of its error, time left.
///
///   /         the page
///   /status   what is known of the render, as JSON
///   /picture  the pixels of the last picture: red, green and blue of each as little-endian floats, row by row
class LivePage {
  public:
    /// `port` -1: kDefaultPort, or any free one if that is in use; 0: any free one. Throws UserError if the port is in
    /// use.
    LivePage(std::shared_ptr<LiveBoard> board, int port);
    ~LivePage();

    /// "http://127.0.0.1:PORT/".
    std::string Address() const;
    /// Answers browsers until the board is closed and the last picture was fetched by those that watch. To be run by a
    /// thread of its own.
    void Run();

    static constexpr int kDefaultPort = 8642;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pbrt
