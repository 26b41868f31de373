// SPDX-License-Identifier: GPL-3.0-or-later
// Enumerations and the names of their values in manifests, records, tables and messages, and tables
// whose items have a name.
//
// Each enumeration has one table beside its definition:
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

/// Whether the enumeration has an enumerator of this value: only then does the compiler print its
/// name, as `V = shearcell::Fluid::cell` and not as `V = (shearcell::Fluid)2`.
template <auto V>
constexpr bool is_enumerator() {
  const std::string_view text = __PRETTY_FUNCTION__;
  return text[text.find("V = ") + 4] != '(';
}

}  // namespace named_detail

/// The names of an enumeration whose values are 0, 1, ..., in that order.
template <class Enum, class... Names>
constexpr auto names_in_order(Names... names) {
  constexpr std::size_t size = sizeof...(Names);
  static_assert(named_detail::is_enumerator<static_cast<Enum>(size - 1)>(),
                "more names than values");
  static_assert(!named_detail::is_enumerator<static_cast<Enum>(size)>(), "a value without a name");
  return std::array<std::string_view, size>{names...};
}

/// Specialised for each enumeration that has names.
template <class Enum>
inline constexpr auto kNames = nullptr;

template <class Enum>
constexpr std::string_view name_of(Enum value) {
  const auto& names = kNames<Enum>;
  return names[static_cast<std::size_t>(value)];
}

/// Nothing when no value has that name.
template <class Enum>
constexpr std::optional<Enum> value_of(std::string_view name) {
  const auto found = std::ranges::find(kNames<Enum>, name);
  if (found == kNames<Enum>.end()) return std::nullopt;
  return static_cast<Enum>(found - kNames<Enum>.begin());
}

/// The item whose member `name` is `name`; null when there is none. A span may be temporary.
const auto* find_named(const auto& items, std::string_view name) {
  const auto found =
      std::ranges::find_if(items, [&](const auto& item) { return item.name == name; });
  return found == items.end() ? nullptr : &*found;
}

}  // namespace shearcell
