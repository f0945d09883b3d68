! The Fortran module: u1 - u2 = u4, twice; u2 - u3 = 0.5; u4 is prescribed.
program tied
    use, intrinsic :: iso_c_binding
    use qless
    implicit none
    type(qless_analysis) :: analysis
    type(qless_elimination) :: elimination
    integer(c_int64_t) :: equations, dofs, rank, redundant, conflicting
    integer(c_int32_t), allocatable :: rows(:), slaves(:), masters(:), prescribed(:), starts(:), columns(:)
    integer(c_int8_t) :: kinds(3)
    real(c_double), allocatable :: coefficients(:), values(:)
    real(c_double) :: u(4), q(1), lambda(3), g(2)
    character(len=:), allocatable :: message
    integer :: ierr

    call qless_analyse(4_c_int64_t, [1, 4, 7, 9], [1, 2, 4, 1, 2, 4, 2, 3], &
                       [1d0, -1d0, -1d0, 2d0, -2d0, -2d0, 1d0, -1d0], [0d0, 0d0, 0.5d0], [4], [0.25d0], analysis, ierr)
    call need(ierr == 0)
    call qless_counts(analysis, equations, dofs, rank, redundant, conflicting, ierr)
    call need(ierr == 0 .and. rank == 2 .and. redundant == 1 .and. conflicting == 0)
    call qless_kinds(analysis, kinds, ierr)
    call need(ierr == 0 .and. all(kinds == [0, 1, 0]))
    call qless_explain(analysis, 2_c_int64_t, rows, coefficients, ierr)
    call need(ierr == 0 .and. all(rows == [1]) .and. all(coefficients == [2d0]))
    call qless_explain(analysis, 4_c_int64_t, rows, coefficients, ierr)
    message = qless_message()
    call need(ierr < 0 .and. index(message, "out of range") > 0)

    call qless_eliminate(analysis, elimination, ierr)
    call need(ierr == 0)
    call qless_free_analysis(analysis, ierr)
    call qless_dofs(elimination, slaves, masters, prescribed, ierr)
    call need(ierr == 0 .and. size(slaves) == 2 .and. size(masters) == 1 .and. all(prescribed == [4]))
    call qless_t(elimination, starts, columns, values, ierr)
    call need(ierr == 0 .and. all(starts == [1, 2, 3]) .and. all(columns == 1) .and. all(values == 1d0))
    call qless_expand(elimination, [7d0], u, ierr)
    call need(ierr == 0 .and. u(1) - u(2) == 0.25d0 .and. u(2) - u(3) == 0.5d0)
    call qless_restrict(elimination, [1d0, 1d0, 1d0, 1d0], q, ierr)
    call need(ierr == 0 .and. q(1) == 3d0)
    call qless_multipliers(elimination, [1d0, 1d0, 1d0, 1d0], lambda, ierr)
    call need(ierr == 0 .and. lambda(2) == 0d0)
    call qless_refresh(elimination, [1d0, 3d0, 0d0], [0d0], ierr)
    call need(ierr == -2)
    call qless_refresh(elimination, [1d0, 2d0, 0d0], [0d0], ierr)
    call qless_g(elimination, g, ierr)
    call need(ierr == 0 .and. maxval(abs(g)) == 1d0)
    call qless_free_elimination(elimination, ierr)
    call qless_expand(elimination, [7d0], u, ierr)
    call need(ierr == -1)
    print '(a)', "module: as expected"

contains

    subroutine need(condition)
        logical, intent(in) :: condition
        if (.not. condition) then
            print '(a)', qless_message()
            error stop 1
        end if
    end subroutine
end program
