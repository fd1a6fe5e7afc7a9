!> Does nothing: what a process costs that loads epcont's libraries.
program bench_empty
  implicit none
end program bench_empty
