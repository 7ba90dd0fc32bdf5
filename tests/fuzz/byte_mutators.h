#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Splits at blanks.
std::vector<std::string> WordsOf(const std::string &text);

/// Number as text that is hard to read, to hold or to calculate with.
std::string ExtremeNumber(Dice &dice);
/// The same as 1, 2, 4 or 8 bytes of either order.
std::string ExtremeWord(Dice &dice);

/// Flips, inserts, deletes, overwrites, cuts off, repeats. Changes within the first `head` bytes are as likely as in
/// the rest. Without effect on what is empty, unless it inserts.
void MutateBytes(std::string &bytes, size_t head, Dice &dice);

/// Replaces a number in a text by an extreme one, or changes it a little. False if there is none.
bool MutateNumberInText(std::string &text, size_t begin, size_t end, Dice &dice);

/// Drops, repeats, swaps, joins lines of [begin, end).
void MutateLines(std::string &text, size_t begin, size_t end, Dice &dice);

}  // namespace pbrt::fuzz
