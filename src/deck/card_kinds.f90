!> Numbers of the cards in the catalogue and in the tables of a deck. Listings count cards in this order.
module epcont_deck_card_kinds
  implicit none
  private

  integer, parameter, public :: &
    card_grid = 1, card_ctria3 = 2, card_pshell = 3, card_mat1 = 4, card_spc = 5, card_spc1 = 6, &
    card_force = 7, card_ploadx1 = 8, card_rbe2 = 9, card_suport = 10, card_cord2r = 11, card_cgap = 12, &
    card_pgap = 13, card_cbar = 14, card_param = 15, card_mats1 = 16, card_tables1 = 17, card_ctria6 = 18, &
    card_cquad4 = 19, card_ctrax3 = 20, card_ctrax6 = 21, card_psolid = 22, card_blseg = 23, &
    card_bconp = 24, card_cquad8 = 25, card_load = 26, card_spcd = 27, card_temp = 28, &
    card_tempd = 29, card_grav = 30, card_rforce = 31, card_moment = 32, card_mpc = 33, card_mpcadd = 34, &
    card_celas1 = 35, card_celas2 = 36, card_pelas = 37, card_nlparm = 38, card_bfric = 39, &
    card_kinds = 39   !! number of cards
  !> Axisymmetric elements, and all elements, which are numbered in this order.
  integer, parameter, public :: ring_cards(*) = [card_ctrax3, card_ctrax6], &
    element_cards(*) = [card_ctria3, card_ctria6, card_cquad4, ring_cards, card_cquad8]
end module epcont_deck_card_kinds
