#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Splits at blanks.
std::vector<std::string> WordsOf(const std::string &text);

/// A number as text that is hard to parse, to store or to calculate with.
std::string ExtremeNumber(Dice &dice);
/// The same as 1, 2, 4 or 8 bytes in either byte order.
std::string ExtremeWord(Dice &dice);

/// Flips, inserts, deletes, overwrites, cuts off, repeats. Changes within the first `head` bytes are as likely as in
/// the rest. Empty bytes change only if something is inserted.
void MutateBytes(std::string &bytes, size_t head, Dice &dice);

/// Replaces a number in a text by an extreme one, or changes it a little. False if there is none.
bool MutateNumberInText(std::string &text, size_t begin, size_t end, Dice &dice);

/// Drops, repeats, swaps or joins lines of [begin, end).
void MutateLines(std::string &text, size_t begin, size_t end, Dice &dice);

}  // namespace pbrt::fuzz
