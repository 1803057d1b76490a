#include "isopath/field/edge_windows.h"

namespace isopath {

std::size_t EdgeWindows::size() const {
  std::size_t size = 0;
  for (const std::vector<Window>& part : parts_) size += part.size();
  return size;
}

void EdgeWindows::add(std::size_t part, Index edge, std::span<const Window> windows) {
  std::vector<Window>& all = parts_[part];
  places_[edge] = {static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(all.size()),
                   static_cast<std::uint32_t>(windows.size())};
  all.insert(all.end(), windows.begin(), windows.end());
}

}  // namespace isopath
