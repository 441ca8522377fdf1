# SPDX-License-Identifier: GPL-3.0-or-later
# Finds types that two files define with one name in one namespace. The linker takes one of their
# destructors for both, and says nothing: a program that has both crashes or does not.
FNR == 1 { depth = 0 }
/^namespace [a-z_0-9:]* ?\{/ { name[++depth] = $2 == "{" ? "" : $2; next }
/^\}  \/\/ namespace/ { if (depth > 0) --depth; next }
/^(struct|class) [A-Za-z_0-9]+[^<;]*\{?$/ {
  path = ""
  for (k = 1; k <= depth; ++k) {
    if (name[k] == "") next  # an unnamed namespace: of this file alone
    path = path name[k] "::"
  }
  type = path $2
  sub(/:$/, "", type)
  if (type in first && first[type] != FILENAME) {
    print FILENAME ":" FNR ": " type " stands in " first[type] " as well"
  }
  if (!(type in first)) first[type] = FILENAME
}
