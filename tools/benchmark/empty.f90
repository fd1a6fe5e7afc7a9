!> Does nothing: what a process costs that loads epcont and its libraries.
program bench_empty
  implicit none
end program bench_empty
