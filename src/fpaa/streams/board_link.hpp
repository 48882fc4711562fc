#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fpaa/device/config_stream.hpp"

namespace bodesmith::fpaa {

/// A serial line: bytes out, bytes in with a time-out.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  virtual void write(std::string_view bytes) = 0;
  /// One byte; nothing when none comes within `seconds`.
  virtual std::optional<std::uint8_t> read(double seconds) = 0;
};

/// Opens a device at 57600 baud, 8 bits, no parity, raw. Throws InputError when it cannot.
std::unique_ptr<SerialPort> open_serial_port(const std::string& device);

struct LinkOptions {
  double timeout_s = 1.0;
  int retries = 3;  ///< after the first try
};

struct LinkReport {
  std::string identity;             ///< answer to '#'
  int chips = 0;                    ///< from the answer to 'T'
  std::vector<std::string> status;  ///< answer to '?' after each packet
  int tries = 0;                    ///< of all questions and packets together
};

/// Speaks the board's protocol: asks for its identity ('#') and its chips ('T'), sends each packet, and asks
/// for the status ('?') after each, which shows that the board is alive and took the packet in. An answer
/// ends with a NUL, is then confirmed with ETX, and must be printable; silence and garbage are asked again.
/// What the status says is not publicly documented: it is shown, and only an answer with "ERR" or "FAIL" in
/// it counts as a refusal. Throws InputError (naming the step) when the retries are used up, the board
/// refuses, or has too few chips.
LinkReport send_packets(SerialPort& port, const std::vector<std::string>& packets, int chips_needed,
                        const LinkOptions& options);

}  // namespace bodesmith::fpaa
