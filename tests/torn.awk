# SPDX-License-Identifier: GPL-3.0-or-later
# Finds comments and strings that a formatter has torn, in C++ files; one line per finding.
#
# Consecutive lines of a comment (same indentation, same marker), or of a string that goes on from
# line to line, are a paragraph. It is torn where
# - a line in its middle ends far before the margin, though no sentence ends there and the first
#   word of the next line would have fitted;
# - its last line, or the line of a string between two others, is a single word;
# - a string with line ends (\n) in it is cut between them.

function say(line, text) { print file ":" line ": " text }

function first_word(text,  words) {
  split(text, words, " ")
  return words[1]
}

function end_paragraph(  i, what) {
  what = kind == "/" ? "comment" : "string"
  for (i = 1; i <= size; ++i) {
    if (i > 1 && text[i] !~ /[^ ] [^ ]/ && length(text[i]) < 30 && (i == size ? kind == "/" : 1)) {
      say(at[i], "a single word on a line of a " what ": " text[i])
    } else if (i < size && width[i] + 1 + length(first_word(text[i + 1])) <= 80 &&
               text[i] !~ /[.:;!?)\]}|]$/ && text[i] !~ /\\n$/ && text[i + 1] ~ /^[a-z(]/) {
      say(at[i], "a line of a " what " ends early: the next word fits")
    }
    if (kind == "\"" && i < size && text[i] ~ /\\n./ && text[i] !~ /\\n$/) {
      say(at[i], "a string is cut between two line ends")
    }
  }
  size = 0
}

function add(mark, words) {
  if (mark != last_mark) end_paragraph()
  last_mark = mark
  kind = mark ~ /"/ ? "\"" : "/"
  ++size
  text[size] = words
  at[size] = FNR
  width[size] = length($0)
}

FNR == 1 { end_paragraph(); last_mark = ""; file = FILENAME }

# Formulas and tables in a comment, which are indented by four and more, are no paragraph.
/^ *\/\/[\/!]?<?    / { end_paragraph(); last_mark = ""; next }

# A comment of its own line: a list item, a command (@) or another indentation begins anew.
match($0, /^ *\/\/[\/!]?<? */) {
  words = substr($0, RLENGTH + 1)
  if (words ~ /^([-*@]|[0-9]+\. |[(][a-z][)])/ || words == "") end_paragraph()
  if (words != "") add(substr($0, 1, RLENGTH), words)
  next
}

# A string that goes on in the next line, or comes from the one before.
match($0, /"([^"\\]|\\.)*"[,;)]*$/) && (!/^ *#/) {
  words = substr($0, RSTART + 1, RLENGTH - 1)
  alone = $0 ~ /^ *"([^"\\]|\\.)*"[,;) ]*$/
  open = $0 ~ /"$/
  sub(/"[,;)]*$/, "", words)
  if (!alone) { end_paragraph(); last_mark = "\"" }
  if (alone || open) add("\"", words)
  if (!open) { end_paragraph(); last_mark = "" }
  next
}

{ end_paragraph(); last_mark = "" }

END { end_paragraph() }
