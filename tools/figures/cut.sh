# Parts of what leviosim prints, as filters for tools/figures.sh.

# table FIRST [COLUMN...]: the table whose first column is FIRST, as far as the next empty line;
# with columns, these only.
table() {
  perl -CSDA -Mutf8 -e '
    my ($first, @wanted) = @ARGV;
    my @lines;
    while (<STDIN>) {
      chomp;
      push @lines, $_ if @lines ? /\S/ : /^\Q$first\E  /;
      last if @lines && !/\S/;
    }
    exit unless @lines;
    if (!@wanted) { print "$_\n" for @lines; exit }

    # Lines after the rows (notes) have no place in the columns.
    my ($header, $rule, @rows) = @lines;
    my $width = length $rule;
    my @cells = ($header);
    for (@rows) { last if /^(¹|\*|…) |^\S+(?: \S+)*:( |$)/; push @cells, $_ }
    # A column is a run of places between two gaps of two blanks or more in every row.
    my $ink = "";
    for (@cells) { $ink = $ink | (s/\S/x/gr =~ s/\s/\0/gr) }
    $ink =~ s/\0/ /g;
    my @columns;
    while ($ink =~ /(x+(?: x+)*)/g) { push @columns, [$-[1], $+[1] - $-[1]] }
    my @shown;
    for my $wanted (@wanted) {
      my ($column) = grep { substr($header, $_->[0], $_->[1]) =~ /^\s*\Q$wanted\E\s*$/ } @columns;
      die "figures: the table of $first has no column $wanted\n" unless $column;
      push @shown, $column;
    }
    my @text = map {
      my $row = $_ . " " x $width;
      join("  ", map { substr $row, $_->[0], $_->[1] } @shown) =~ s/\s+$//r
    } @cells;
    my ($longest) = sort { $b <=> $a } map { length } @text;
    splice @text, 1, 0, "─" x $longest;
    print "$_\n" for @text;' "$@"
}

# lines PATTERN...: the lines that match one of the patterns.
lines() { grep -E "$(printf '%s|' "$@" | sed 's/|$//')"; }

# rows PATTERN...: of a table, the header and the rows that match one of the patterns.
rows() { awk -v patterns="$(printf '%s|' "$@" | sed 's/|$//')" 'NR <= 2 || $0 ~ patterns'; }

# first N: the first N lines, and … if there are more.
first() { awk -v most="$1" 'NR <= most { print } NR == most + 1 { print "…" }'; }

# narrow N: lines of N characters at most; what is cut off is …
narrow() { perl -CSD -Mutf8 -ne 'chomp; print length > '"$1"' ? substr($_, 0, '"$1"' - 1) . "…" : $_, "\n"'; }

# outside_tolerance: of the rows of microbench, those that are marked, each below its kernel.
outside_tolerance() {
  awk '/cores  unit/ { if (!header++) print; next }
    !/!$/ && !/  [18]  / { kernel = $0; next }
    /!$/ { if (kernel) print kernel; kernel = ""; print }'
}
