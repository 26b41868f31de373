// SPDX-License-Identifier: GPL-3.0-or-later
// The names of enumerators in manifests, records, tables and messages, and a search for named
// items.
//
// Each enumeration has one table of names beside its definition, for example:
//   template <>
//   inline constexpr auto kNames<Fluid> =
//       names_in_order<Fluid>("still", "cell");
// An enumerator without a name is a compile-time error.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace shearcell {

namespace named_detail {

/// Whether V is an enumerator. The compiler prints an enumerator as `V = shearcell::Fluid::cell`,
/// and any other value as `V = (shearcell::Fluid)2`.
template <auto V>
constexpr bool is_enumerator() {
  const std::string_view text = __PRETTY_FUNCTION__;
  return text[text.find("V = ") + 4] != '(';
}

}  // namespace named_detail

/// Table of the names of the enumerators 0, 1, 2, ... in this order.
template <class Enum, class... Names>
constexpr auto names_in_order(Names... names) {
  constexpr std::size_t size = sizeof...(Names);
  static_assert(named_detail::is_enumerator<static_cast<Enum>(size - 1)>(),
                "there are more names than enumerators");
  static_assert(!named_detail::is_enumerator<static_cast<Enum>(size)>(), "a name is missing");
  return std::array<std::string_view, size>{names...};
}

/// Table of names. It is specialised for each enumeration that has names.
template <class Enum>
inline constexpr auto kNames = nullptr;

template <class Enum>
constexpr std::string_view name_of(Enum value) {
  const auto& names = kNames<Enum>;
  return names[static_cast<std::size_t>(value)];
}

/// The enumerator with this name, or nullopt if no enumerator has the name.
template <class Enum>
constexpr std::optional<Enum> value_of(std::string_view name) {
  const auto found = std::ranges::find(kNames<Enum>, name);
  if (found == kNames<Enum>.end()) return std::nullopt;
  return static_cast<Enum>(found - kNames<Enum>.begin());
}

/// Pointer to the item with this name, or null. `items` may be a temporary span.
const auto* find_named(const auto& items, std::string_view name) {
  const auto found =
      std::ranges::find_if(items, [&](const auto& item) { return item.name == name; });
  return found == items.end() ? nullptr : &*found;
}

}  // namespace shearcell
