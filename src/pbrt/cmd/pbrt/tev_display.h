#pragma once
#include <string>

#include "pbrt/cmd/pbrt/live_board.h"

namespace pbrt {

/// Sends every picture of the board to a viewer that speaks the protocol of tev (https://github.com/Tom94/tev), until
/// the board is closed and the last picture is sent, or the viewer is gone. `server`: "host:port". To be run by a
/// thread of its own.
void ShowInTev(LiveBoard &board, const std::string &server);

/// Host and port of "host:port"; an IPv6 address may stand in brackets. Empty strings if it is something else.
std::pair<std::string, std::string> SplitServer(const std::string &server);

}  // namespace pbrt
