#pragma once

#include <cstddef>

#include "isopath/field/window_list.h"

namespace isopath {

/// Lists of windows that meet on a half-edge, made one and freed of what is longer than a way that is known: passes
/// over whole lists, compiled and bounded as those of list_step.h.

/// Merges two sorted lists.
void merge_lists(const WindowArrays& a, std::size_t n_a, const WindowArrays& b, std::size_t n_b,
                 const WindowArrays& to);

/// Cuts off what is farther than along the edge from one of its two vertices, where the distances are at most `at_tail`
/// and `at_head`, and drops windows of which no part or only such parts remain (Xin & Wang 2009, and the part of a
/// window of which the same holds). Returns the number left.
std::size_t trim_by_vertices(const WindowArrays& windows, std::size_t n, double length, double at_tail, double at_head,
                             double margin);

/// Cuts off what a window's neighbour in the list reaches by a shorter way. Where the beams of circles cross, a ray
/// that is longer at an end of the overlap is longer on all its way beyond the crossing; of straight fronts only the
/// overlap is cut. Reads `windows`, writes the intervals that are left to `begin` and `end`; an empty one has begin >=
/// end. Returns false, and writes nothing, where fewer than a quarter of the windows overlap with more than the next
/// one: it is not worth its time there.
bool trim_by_neighbours(const WindowArrays& windows, std::size_t n, double margin, double* begin, double* end);

/// Gives the windows these intervals and drops those whose interval is empty; returns the number left.
std::size_t set_intervals(const WindowArrays& windows, std::size_t n, const double* begin, const double* end);

}  // namespace isopath
